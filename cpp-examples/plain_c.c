/* The C interface, on which the C++ class is built. Every function returns a status. */
#include "masked_occlusion_culling.h"

#include <stdio.h>
#include <stdlib.h>

static void check(int32_t status, const char *what) {
    if (status != MOC_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", what, MOC_StatusText(status));
        exit(1);
    }
}

int main(void) {
    if (MOC_GetAbiVersion() != MOC_ABI_VERSION) {
        fprintf(stderr, "the header and the library do not match\n");
        return 1;
    }

    MOC_Settings settings = {.size = sizeof settings};
    check(MOC_DefaultSettings(&settings), "settings");
    struct MaskedOcclusionCulling *moc = NULL;
    check(MOC_Create(&settings, &moc), "create");
    check(MOC_SetResolution(moc, 800, 450), "resolution");
    check(MOC_SetNearClipPlane(moc, 0.1f), "near plane");
    check(MOC_ClearBuffer(moc), "clear");

    /* A square in clip space (x, y, z, w), 5 away. */
    const float vertices[] = {
        -4, -4, 0, 5,
        4, -4, 0, 5,
        4, 4, 0, 5,
        -4, 4, 0, 5,
    };
    const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    /* Fields that are not named are null or zero: no matrix, and packed vertices. */
    MOC_Mesh square = {
        .size = sizeof square,
        .vertices = vertices,
        .vertex_count = 4,
        .indices = triangles,
        .triangle_count = 2,
        .winding = MOC_BACKFACE_CW,
        .clip_planes = MOC_CLIP_PLANE_ALL,
    };
    int32_t result;
    check(MOC_RenderMesh(moc, &square, &result), "render");

    check(MOC_TestRect(moc, -0.1f, -0.1f, 0.1f, 0.1f, 8, &result), "test");
    printf("behind the square: %s\n", result == MOC_OCCLUDED ? "occluded" : "visible");
    const int hidden = result == MOC_OCCLUDED;

    /* Because the number of vertices is given, an invalid index is an error, and nothing is drawn. */
    const uint32_t bad[] = {0, 1, 4};
    square.indices = bad;
    square.triangle_count = 1;
    const int32_t status = MOC_RenderMesh(moc, &square, NULL);
    printf("an index too high: %s\n", MOC_StatusText(status));

    check(MOC_Destroy(moc), "destroy");
    return hidden && status == MOC_STATUS_INDEX_OUT_OF_RANGE ? 0 : 1;
}
