/* The same engine in C: draws a wall and tests what it hides. The exit code says whether the answers are correct. */
#include <masked_occlusion_culling.h>

#include <stdio.h>

int main(void) {
    /* A wall over the left half of the screen, 5 away: x, y, z (not used), w. */
    const float wall[] = {
        -5, -5, 0, 5,
        0, -5, 0, 5,
        0, 5, 0, 5,
        -5, 5, 0, 5,
    };
    const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    MOC_Settings settings = {.size = sizeof settings};
    struct MaskedOcclusionCulling *moc = NULL;
    int32_t drawn, hidden, beside;

    if (MOC_GetAbiVersion() != MOC_ABI_VERSION) {
        fprintf(stderr, "the header and the library do not match\n");
        return 2;
    }
    if (MOC_DefaultSettings(&settings) != MOC_STATUS_OK || MOC_Create(&settings, &moc) != MOC_STATUS_OK
        || MOC_SetResolution(moc, 640, 360) != MOC_STATUS_OK || MOC_ClearBuffer(moc) != MOC_STATUS_OK
        || MOC_RenderTriangles(moc, wall, triangles, 2, NULL, MOC_BACKFACE_CW, MOC_CLIP_PLANE_ALL, NULL, &drawn) != MOC_STATUS_OK
        || MOC_TestRect(moc, -0.7f, -0.2f, -0.3f, 0.2f, 8, &hidden) != MOC_STATUS_OK
        || MOC_TestRect(moc, 0.3f, -0.2f, 0.7f, 0.2f, 8, &beside) != MOC_STATUS_OK || MOC_Destroy(moc) != MOC_STATUS_OK) {
        fprintf(stderr, "a call was refused\n");
        return 2;
    }
    printf("C, behind the wall: %s\n", hidden == MOC_OCCLUDED ? "right" : "WRONG");
    printf("C, beside the wall: %s\n", beside == MOC_VISIBLE ? "right" : "WRONG");
    return hidden == MOC_OCCLUDED && beside == MOC_VISIBLE ? 0 : 1;
}
