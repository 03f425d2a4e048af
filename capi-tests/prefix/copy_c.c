/*
 * One copy of the library in C: compiled without changes, and with MOC_SYMBOL_PREFIX. Returns 0, or the line of the failed check.
 */
#include "masked_occlusion_culling.h"
/* This file uses the short names; without a prefix this include has no effect. */
#include "moc_names.h"

#ifdef MOC_SYMBOL_PREFIX
#define NAME acme_in_c
#else
#define NAME plain_in_c
#endif

int NAME(float side);

#define EXPECT(condition)    \
    do                       \
    {                        \
        if (!(condition))    \
            return __LINE__; \
    } while (0)

int NAME(float side)
{
    const float wall[] = {0, -5, 0, 5, side * 5, -5, 0, 5, side * 5, 5, 0, 5, 0, 5, 0, 5};
    const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    MaskedOcclusionCulling *moc = NULL;
    int32_t behind = -1, beside = -1;
    EXPECT(MOC_Create(NULL, &moc) == MOC_STATUS_OK);
    EXPECT(MOC_SetResolution(moc, 256, 128) == MOC_STATUS_OK);
    EXPECT(MOC_ClearBuffer(moc) == MOC_STATUS_OK);
    EXPECT(MOC_RenderTriangles(moc, wall, triangles, 2, NULL, MOC_BACKFACE_NONE, MOC_CLIP_PLANE_ALL, NULL, NULL) ==
           MOC_STATUS_OK);
    EXPECT(MOC_TestRect(moc, side * 0.5f - 0.2f, -0.2f, side * 0.5f + 0.2f, 0.2f, 8, &behind) == MOC_STATUS_OK);
    EXPECT(MOC_TestRect(moc, -side * 0.5f - 0.2f, -0.2f, -side * 0.5f + 0.2f, 0.2f, 8, &beside) == MOC_STATUS_OK);
    EXPECT(behind == MOC_OCCLUDED && beside == MOC_VISIBLE);
    EXPECT(MOC_Destroy(moc) == MOC_STATUS_OK);
    return 0;
}
