/* An object in guarded memory, and a check that it still works. */
#ifndef CAPI_TESTS_GUARDED_OBJECT_H
#define CAPI_TESTS_GUARDED_OBJECT_H

#include "check.h"
#include "guarded.h"
#include "masked_occlusion_culling.h"

enum { W = 141, H = 77 };

static const int32_t IMPLEMENTATIONS[] = {MOC_SCALAR, MOC_SSE2, MOC_SSE41, MOC_AVX2, MOC_AVX512};
enum { N_IMPLEMENTATIONS = sizeof IMPLEMENTATIONS / sizeof *IMPLEMENTATIONS };

/* An object whose own memory is guarded. */
static inline MaskedOcclusionCulling *make(int32_t implementation, int32_t rule)
{
    MOC_Settings settings = {0};
    MaskedOcclusionCulling *moc = NULL;
    settings.size = sizeof settings;
    CHECK_EQ(MOC_DefaultSettings(&settings), MOC_STATUS_OK);
    settings.implementation = implementation;
    settings.update_rule = rule;
    settings.alloc = guarded_callback_alloc;
    settings.free = guarded_callback_free;
    CHECK_EQ(MOC_Create(&settings, &moc), MOC_STATUS_OK);
    if (moc == NULL)
        abort();
    CHECK_EQ(MOC_SetResolution(moc, W, H), MOC_STATUS_OK);
    return moc;
}

/* Checks that the object still works: a wall hides what is behind it, and after a clear nothing is hidden. */
static inline void still_works(MaskedOcclusionCulling *moc)
{
    float quad[16];
    int32_t result = -1;
    CHECK_EQ(MOC_SetNearClipPlane(moc, 0.0f), MOC_STATUS_OK);
    CHECK_EQ(MOC_ClearBuffer(moc), MOC_STATUS_OK);
    CHECK_EQ(MOC_TestRect(moc, -0.5f, -0.5f, 0.5f, 0.5f, 20.0f, &result), MOC_STATUS_OK);
    CHECK_EQ(result, MOC_VISIBLE);
    quad_at(quad, -2.0f, -2.0f, 2.0f, 2.0f, 10.0f);
    CHECK_EQ(MOC_RenderTriangles(moc, quad, QUAD, 2, NULL, MOC_BACKFACE_CW, MOC_CLIP_PLANE_ALL, NULL, NULL),
             MOC_STATUS_OK);
    CHECK_EQ(MOC_TestRect(moc, -0.5f, -0.5f, 0.5f, 0.5f, 20.0f, &result), MOC_STATUS_OK);
    CHECK_EQ(result, MOC_OCCLUDED);
    CHECK_EQ(MOC_ClearBuffer(moc), MOC_STATUS_OK);
}

#endif
