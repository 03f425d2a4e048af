/* 32-bit programs may leave the x87 unit at single precision, as Direct3D 9 does by default. The library must draw the same
 * bits: it computes in SSE registers, and anything that passes through the x87 unit is exact there. Small triangles, clipped
 * ones, and triangles so large that their edges need 128-bit integers. */
#define _DEFAULT_SOURCE 1
#include "guarded_object.h"

#include <fpu_control.h>

enum { N = 300 };

static float vertices[12 * N];
static uint32_t indices[3 * N];

static void make_triangles(void)
{
    int t, k;
    random_triangles(vertices, indices, N, 5);
    for (t = 0; t < N; t++) {
        for (k = 0; k < 12; k++) {
            /* Corners up to 100,000 pixels away, and some behind the eye. */
            if (t % 5 == 1 && k % 4 != 3)
                vertices[12 * t + k] *= 1000.0f;
            if (t % 5 == 2 && k == 7)
                vertices[12 * t + k] *= -1.0f;
        }
    }
}

/* The depth of every pixel. */
static void draw(int32_t implementation, int32_t rule, float *depth)
{
    MaskedOcclusionCulling *moc = make(implementation, rule);
    CHECK_EQ(MOC_SetNearClipPlane(moc, 0.3f), MOC_STATUS_OK);
    CHECK_EQ(MOC_RenderTriangles(moc, vertices, indices, N, NULL, MOC_BACKFACE_NONE, MOC_CLIP_PLANE_ALL, NULL, NULL),
             MOC_STATUS_OK);
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, depth, 0), MOC_STATUS_OK);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

static void set_precision(unsigned bits)
{
    fpu_control_t word;
    _FPU_GETCW(word);
    word = (fpu_control_t)((word & ~(unsigned)_FPU_EXTENDED) | bits);
    _FPU_SETCW(word);
}

int main(void)
{
    static float full[W * H], reduced[W * H];
    volatile double one = 1.0, three = 3.0, before, after;
    int32_t rule;
    int i;
    make_triangles();
    before = one / three;
    set_precision(_FPU_SINGLE);
    after = one / three;
    set_precision(_FPU_EXTENDED);
    CHECK(before != after); /* this program's own arithmetic is affected */
    for (i = 0; i < N_IMPLEMENTATIONS; i++) {
        for (rule = MOC_UPDATE_RULE_THREE_LAYER; rule <= MOC_UPDATE_RULE_FOUR_LAYER; rule++) {
            draw(IMPLEMENTATIONS[i], rule, full);
            set_precision(_FPU_SINGLE);
            draw(IMPLEMENTATIONS[i], rule, reduced);
            set_precision(_FPU_EXTENDED);
            CHECK(memcmp(full, reduced, sizeof full) == 0);
        }
    }
    return check_report("precision_control");
}
