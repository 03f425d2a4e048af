/* What no caller should do: null pointers, invalid integers, NaN and infinities. Every call must return the status that
 * the header promises, and memory is intact. */
#define _DEFAULT_SOURCE 1
#include "deadline.h"
#include "guarded_object.h"

#include <float.h>
#include <limits.h>
#include <math.h>

/* No call may leave behind a NaN or an invalid depth. */
static void check_depth(const MaskedOcclusionCulling *moc)
{
    float *depth = (float *)guarded_alloc(4, W * H * sizeof(float));
    int i, wrong = 0;
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, depth, 0), MOC_STATUS_OK);
    for (i = 0; i < W * H; i++)
        wrong += isnan(depth[i]) || isinf(depth[i]);
    CHECK_EQ(wrong, 0);
    CHECK_EQ(MOC_ComputePixelDepthBufferChecked(moc, depth, W * H, 1), MOC_STATUS_OK);
    guarded_release(depth, W * H * sizeof(float));
}

static void null_pointers(void)
{
    const float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    MaskedOcclusionCulling *moc = make(MOC_AVX512, MOC_UPDATE_RULE_THREE_LAYER), *none = NULL;
    MOC_TriList list = {3, 1, NULL};
    MOC_Settings settings = {.size = sizeof settings};
    MOC_Statistics stats = {.size = sizeof stats};
    int64_t dropped;
    MOC_AlignedAlloc alloc;
    MOC_AlignedFree release;
    float quad[16], number, out[16];
    uint32_t w = 0, h = 0;
    int32_t r;
    quad_at(quad, -2.0f, -2.0f, 2.0f, 2.0f, 10.0f);
#define IS_NULL(call) CHECK_EQ(call, MOC_STATUS_NULL_POINTER)
    /* As IS_NULL, for calls that return their answer in r. */
#define IS_NULL_VISIBLE(call)                                                             \
    do {                                                                                  \
        r = MOC_OCCLUDED;                                                                 \
        IS_NULL(call);                                                                    \
        CHECK_EQ(r, MOC_VISIBLE);                                                         \
    } while (0)
    IS_NULL(MOC_DefaultSettings(NULL));
    IS_NULL(MOC_Create(NULL, NULL));
    CHECK_EQ(MOC_DefaultSettings(&settings), MOC_STATUS_OK);
    IS_NULL(MOC_Create(&settings, NULL));
    settings.alloc = guarded_callback_alloc;
    IS_NULL(MOC_Create(&settings, &none));
    settings.alloc = NULL;
    settings.free = guarded_callback_free;
    IS_NULL(MOC_Create(&settings, &none));
    CHECK(none == NULL);
    IS_NULL(MOC_SetResolution(NULL, 8, 8));
    IS_NULL(MOC_GetResolution(NULL, &w, &h));
    IS_NULL(MOC_GetResolution(moc, NULL, &h));
    IS_NULL(MOC_GetResolution(moc, &w, NULL));
    IS_NULL(MOC_ComputeBinWidthHeight(NULL, 1, 1, &w, &h));
    IS_NULL(MOC_ComputeBinWidthHeight(moc, 1, 1, NULL, &h));
    IS_NULL(MOC_ComputeBinWidthHeight(moc, 1, 1, &w, NULL));
    IS_NULL(MOC_SetNearClipPlane(NULL, 1.0f));
    IS_NULL(MOC_GetNearClipPlane(NULL, &number));
    IS_NULL(MOC_GetNearClipPlane(moc, NULL));
    IS_NULL(MOC_GetImplementation(NULL, &r));
    IS_NULL(MOC_GetImplementation(moc, NULL));
    IS_NULL(MOC_GetUpdateRule(NULL, &r));
    IS_NULL(MOC_GetUpdateRule(moc, NULL));
    IS_NULL(MOC_GetAllocFreeCallback(NULL, &alloc, &release));
    IS_NULL(MOC_GetAllocFreeCallback(moc, NULL, &release));
    IS_NULL(MOC_GetAllocFreeCallback(moc, &alloc, NULL));
    IS_NULL(MOC_ClearBuffer(NULL));
    IS_NULL(MOC_MergeBuffer(NULL, moc));
    IS_NULL(MOC_MergeBuffer(moc, NULL));
    IS_NULL(MOC_MergeBuffer(NULL, NULL));
    IS_NULL(MOC_GetStatistics(NULL, &stats));
    IS_NULL(MOC_GetStatistics(moc, NULL));
    IS_NULL(MOC_GetDroppedTriangles(NULL, &dropped));
    IS_NULL(MOC_GetDroppedTriangles(moc, NULL));
    IS_NULL(MOC_ComputePixelDepthBuffer(NULL, out, 0));
    IS_NULL(MOC_ComputePixelDepthBuffer(moc, NULL, 0));
    IS_NULL(MOC_ComputePixelDepthBufferChecked(NULL, out, 16, 0));
    IS_NULL(MOC_ComputePixelDepthBufferChecked(moc, NULL, W * H, 0));
    IS_NULL(MOC_TestRect(moc, 0, 0, 1, 1, 1, NULL));
    IS_NULL_VISIBLE(MOC_TestRect(NULL, 0, 0, 1, 1, 1, &r));
    IS_NULL(MOC_TransformVertices(NULL, quad, out, 4, NULL));
    IS_NULL(MOC_TransformVertices(matrix, NULL, out, 4, NULL));
    IS_NULL(MOC_TransformVertices(matrix, quad, NULL, 4, NULL));
    IS_NULL(MOC_RenderTrilist(NULL, &list, NULL));
    IS_NULL(MOC_RenderTrilist(moc, NULL, NULL));
    IS_NULL(MOC_RenderTrilist(moc, &list, NULL));
#define REST NULL, MOC_BACKFACE_CW, MOC_CLIP_PLANE_ALL, NULL, &r
    IS_NULL_VISIBLE(MOC_RenderTriangles(NULL, quad, QUAD, 2, REST));
    IS_NULL_VISIBLE(MOC_RenderTriangles(moc, NULL, QUAD, 2, REST));
    IS_NULL_VISIBLE(MOC_RenderTriangles(moc, quad, NULL, 2, REST));
    IS_NULL_VISIBLE(MOC_RenderTrianglesChecked(NULL, quad, 16, QUAD, 2, REST));
    IS_NULL_VISIBLE(MOC_RenderTrianglesChecked(moc, NULL, 16, QUAD, 2, REST));
    IS_NULL_VISIBLE(MOC_RenderTrianglesChecked(moc, quad, 16, NULL, 2, REST));
    IS_NULL_VISIBLE(MOC_TestTriangles(NULL, quad, QUAD, 2, REST));
    IS_NULL_VISIBLE(MOC_TestTriangles(moc, NULL, QUAD, 2, REST));
    IS_NULL_VISIBLE(MOC_TestTriangles(moc, quad, NULL, 2, REST));
    IS_NULL_VISIBLE(MOC_TestTrianglesChecked(NULL, quad, 16, QUAD, 2, REST));
    IS_NULL_VISIBLE(MOC_TestTrianglesChecked(moc, NULL, 16, QUAD, 2, REST));
    IS_NULL_VISIBLE(MOC_TestTrianglesChecked(moc, quad, 16, NULL, 2, REST));
    IS_NULL_VISIBLE(MOC_BinTriangles(NULL, quad, QUAD, 2, &list, 1, 1, REST));
    IS_NULL_VISIBLE(MOC_BinTriangles(moc, NULL, QUAD, 2, &list, 1, 1, REST));
    IS_NULL_VISIBLE(MOC_BinTriangles(moc, quad, NULL, 2, &list, 1, 1, REST));
    IS_NULL_VISIBLE(MOC_BinTriangles(moc, quad, QUAD, 2, NULL, 1, 1, REST));
    IS_NULL_VISIBLE(MOC_BinTriangles(moc, quad, QUAD, 2, &list, 1, 1, REST)); /* room without memory */
    IS_NULL_VISIBLE(MOC_BinTrianglesChecked(NULL, quad, 16, QUAD, 2, &list, 1, 1, REST));
    IS_NULL_VISIBLE(MOC_BinTrianglesChecked(moc, NULL, 16, QUAD, 2, &list, 1, 1, REST));
    IS_NULL_VISIBLE(MOC_BinTrianglesChecked(moc, quad, 16, NULL, 2, &list, 1, 1, REST));
    IS_NULL_VISIBLE(MOC_BinTrianglesChecked(moc, quad, 16, QUAD, 2, NULL, 1, 1, REST));

    /* Zero triangles need no arrays; an empty list needs no memory. */
    CHECK_EQ(MOC_RenderTriangles(moc, NULL, NULL, 0, REST), MOC_STATUS_OK);
    CHECK_EQ(r, MOC_VIEW_CULLED);
    CHECK_EQ(MOC_TestTriangles(moc, NULL, NULL, 0, REST), MOC_STATUS_OK);
    CHECK_EQ(r, MOC_VIEW_CULLED);
    CHECK_EQ(MOC_RenderTrianglesChecked(moc, NULL, 0, NULL, 0, REST), MOC_STATUS_OK);
    CHECK_EQ(r, MOC_VIEW_CULLED);
    list.capacity = list.count = 0;
    CHECK_EQ(MOC_RenderTrilist(moc, &list, NULL), MOC_STATUS_OK);
    CHECK_EQ(MOC_BinTriangles(moc, quad, QUAD, 2, &list, 1, 1, REST), MOC_STATUS_LIST_FULL);
    CHECK_EQ(r, MOC_VISIBLE);
    CHECK_EQ(list.count, 0);
    still_works(moc);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

static void wrong_integers(void)
{
    const int32_t wrong[] = {-2, 4, 15, 18, 32, 0x80, INT_MAX, INT_MIN};
    MaskedOcclusionCulling *moc = make(MOC_AVX512, MOC_UPDATE_RULE_THREE_LAYER), *none;
    float quad[16], storage[9 * 4];
    uint32_t w = 1, h = 1;
    static float depth[W * H];
    MOC_TriList list = {4, 0, NULL};
    int32_t r;
    size_t i, k;
    list.data = storage;
    quad_at(quad, -2.0f, -2.0f, 2.0f, 2.0f, 10.0f);
    for (i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        for (k = 0; k < 3; k++) {
            MOC_Settings settings = {.size = sizeof settings};
            int32_t *field[] = {&settings.implementation, &settings.update_rule, &settings.y_axis};
            CHECK_EQ(MOC_DefaultSettings(&settings), MOC_STATUS_OK);
            *field[k] = wrong[i];
            none = moc;
            CHECK_EQ(MOC_Create(&settings, &none), MOC_STATUS_INVALID_ENUM);
            CHECK(none == NULL);
        }
#define IS_WRONG(call)                                                                    \
    do {                                                                                  \
        r = MOC_OCCLUDED;                                                                 \
        CHECK_EQ(call, MOC_STATUS_INVALID_ENUM);                                          \
        CHECK_EQ(r, MOC_VISIBLE);                                                         \
    } while (0)
        IS_WRONG(MOC_RenderTriangles(moc, quad, QUAD, 2, NULL, wrong[i], MOC_CLIP_PLANE_ALL, NULL, &r));
        IS_WRONG(MOC_TestTriangles(moc, quad, QUAD, 2, NULL, wrong[i], MOC_CLIP_PLANE_ALL, NULL, &r));
        IS_WRONG(MOC_BinTriangles(moc, quad, QUAD, 2, &list, 1, 1, NULL, wrong[i], MOC_CLIP_PLANE_ALL, NULL, &r));
        if ((wrong[i] & ~0x1f) != 0) {
            IS_WRONG(MOC_RenderTriangles(moc, quad, QUAD, 2, NULL, MOC_BACKFACE_CW, wrong[i], NULL, &r));
            IS_WRONG(MOC_TestTriangles(moc, quad, QUAD, 2, NULL, MOC_BACKFACE_CW, wrong[i], NULL, &r));
            IS_WRONG(MOC_BinTriangles(moc, quad, QUAD, 2, &list, 1, 1, NULL, MOC_BACKFACE_CW, wrong[i], NULL, &r));
        }
        CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, depth, wrong[i]), MOC_STATUS_INVALID_ENUM);
        if (wrong[i] < 0) {
            CHECK_EQ(MOC_RenderTriangles(moc, quad, QUAD, wrong[i], REST), MOC_STATUS_INVALID_SIZE);
            CHECK_EQ(MOC_TestTriangles(moc, quad, QUAD, wrong[i], REST), MOC_STATUS_INVALID_SIZE);
            CHECK_EQ(MOC_BinTriangles(moc, quad, QUAD, wrong[i], &list, 1, 1, REST), MOC_STATUS_INVALID_SIZE);
        }
    }
    CHECK_EQ(list.count, 0);

    /* Sizes. */
    {
        const uint32_t sizes[] = {0, 16385, 0x10000, 0x7fffffff, 0x80000000u, UINT32_MAX};
        for (i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            CHECK_EQ(MOC_SetResolution(moc, sizes[i], 8), MOC_STATUS_INVALID_SIZE);
            CHECK_EQ(MOC_SetResolution(moc, 8, sizes[i]), MOC_STATUS_INVALID_SIZE);
            CHECK_EQ(MOC_SetResolution(moc, sizes[i], sizes[i]), MOC_STATUS_INVALID_SIZE);
            w = h = 1;
            CHECK_EQ(MOC_ComputeBinWidthHeight(moc, sizes[i], 1, &w, &h), MOC_STATUS_INVALID_SIZE);
            CHECK(w == 0 && h == 0);
            CHECK_EQ(MOC_ComputeBinWidthHeight(moc, 1, sizes[i], &w, &h), MOC_STATUS_INVALID_SIZE);
            CHECK_EQ(MOC_BinTriangles(moc, quad, QUAD, 2, &list, sizes[i], 1, REST), MOC_STATUS_INVALID_SIZE);
            CHECK_EQ(MOC_BinTriangles(moc, quad, QUAD, 2, &list, 1, sizes[i], REST), MOC_STATUS_INVALID_SIZE);
            CHECK_EQ(MOC_BinTriangles(moc, quad, QUAD, 2, &list, sizes[i], sizes[i], REST), MOC_STATUS_INVALID_SIZE);
        }
        CHECK_EQ(MOC_ComputeBinWidthHeight(moc, W / 32 + 1, 1, &w, &h), MOC_STATUS_INVALID_SIZE);
        CHECK_EQ(MOC_ComputeBinWidthHeight(moc, 1, H / 8 + 1, &w, &h), MOC_STATUS_INVALID_SIZE);
        CHECK_EQ(MOC_GetResolution(moc, &w, &h), MOC_STATUS_OK);
        CHECK(w == W && h == H);
    }

    /* Rectangles. */
    {
        const MOC_ScissorRect bad[] = {
            {1, 0, 32, 8},     {0, 4, 32, 8},       {0, 0, 33, 8},           {0, 0, 32, 9},
            {-32, 0, 32, 8},   {0, -8, 32, 8},      {0, 0, 192, 8},          {0, 0, 32, 88},
            {0, 0, INT_MAX, H}, {0, 0, W, INT_MAX}, {INT_MIN, INT_MIN, W, H}, {0, 0, INT_MIN, INT_MIN},
            {0, 0, 0x7fffffe0, 0x7ffffff8},
        };
        const MOC_ScissorRect good[] = {{0, 0, W, H}, {32, 8, 64, 16}, {128, 72, W, H}, {0, 0, 160, 80}, {0, 0, 0, 0}};
        list.count = 0;
        CHECK_EQ(MOC_BinTriangles(moc, quad, QUAD, 2, &list, 1, 1, REST), MOC_STATUS_OK);
        for (i = 0; i < sizeof bad / sizeof *bad; i++)
            CHECK_EQ(MOC_RenderTrilist(moc, &list, &bad[i]), MOC_STATUS_INVALID_SIZE);
        MOC_ComputePixelDepthBuffer(moc, depth, 0);
        for (i = 0; i < W * H; i++)
            if (depth[i] >= 0.0f)
                break;
        CHECK_EQ(i, W * H);
        for (i = 0; i < sizeof good / sizeof *good; i++)
            CHECK_EQ(MOC_RenderTrilist(moc, &list, &good[i]), MOC_STATUS_OK);
        list.count = 5;
        CHECK_EQ(MOC_RenderTrilist(moc, &list, NULL), MOC_STATUS_INVALID_SIZE);
        CHECK_EQ(MOC_BinTriangles(moc, quad, QUAD, 2, &list, 1, 1, REST), MOC_STATUS_LIST_FULL);
        CHECK_EQ(list.count, 5);
        list.count = UINT32_MAX;
        CHECK_EQ(MOC_RenderTrilist(moc, &list, NULL), MOC_STATUS_INVALID_SIZE);
        CHECK_EQ(MOC_BinTriangles(moc, quad, QUAD, 2, &list, 1, 1, REST), MOC_STATUS_LIST_FULL);
    }
    still_works(moc);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

/* With 32-bit pointers: counts larger than any array can be. They are rejected before anything is read. */
static void larger_than_memory(void)
{
#if UINTPTR_MAX <= 0xffffffffu
    const float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const int32_t counts[] = {0x0aaaaaab, 0x15555556, 0x20000000, 0x40000000, 0x55555556, INT_MAX};
    const uint32_t lengths[] = {0x08000000, 0x10000000, 0x1c71c71d, 0x20000000, 0x40000000, 0x80000000u, UINT32_MAX};
    MaskedOcclusionCulling *moc = make(MOC_AVX512, MOC_UPDATE_RULE_THREE_LAYER);
    float quad[16], storage[9 * 4], out[16];
    MOC_TriList list = {4, 0, NULL};
    int32_t r;
    size_t i;
    list.data = storage;
    quad_at(quad, -2.0f, -2.0f, 2.0f, 2.0f, 10.0f);
#define IS_TOO_LARGE(call) CHECK_EQ(call, MOC_STATUS_INVALID_SIZE)
    for (i = 0; i < sizeof counts / sizeof *counts; i++) {
        if (counts[i] > 0x0aaaaaaa) {
            IS_TOO_LARGE(MOC_RenderTriangles(moc, quad, QUAD, counts[i], REST));
            IS_TOO_LARGE(MOC_RenderTrianglesChecked(moc, quad, 16, QUAD, counts[i], REST));
            IS_TOO_LARGE(MOC_TestTriangles(moc, quad, QUAD, counts[i], REST));
            IS_TOO_LARGE(MOC_TestTrianglesChecked(moc, quad, 16, QUAD, counts[i], REST));
            IS_TOO_LARGE(MOC_BinTriangles(moc, quad, QUAD, counts[i], &list, 1, 1, REST));
            IS_TOO_LARGE(MOC_BinTrianglesChecked(moc, quad, 16, QUAD, counts[i], &list, 1, 1, REST));
        }
    }
    for (i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        IS_TOO_LARGE(MOC_TransformVertices(matrix, quad, out, lengths[i], NULL));
        list.capacity = list.count = lengths[i];
        IS_TOO_LARGE(MOC_RenderTrilist(moc, &list, NULL));
        list.count = 0;
        IS_TOO_LARGE(MOC_BinTriangles(moc, quad, QUAD, 2, &list, 1, 1, REST));
        CHECK_EQ(list.count, 0);
        if (lengths[i] >= 0x20000000) {
            const MaskedOcclusionCulling *others[1] = {moc};
            IS_TOO_LARGE(MOC_MergeBuffers(moc, others, lengths[i]));
        }
    }
    {
        MOC_Recording *recording = NULL;
        IS_TOO_LARGE(MOC_RecordingFromMemory((const uint8_t *)quad, 0x80000000u, &recording));
    }
    still_works(moc);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
#endif
}

/* Calls on an object whose resolution was never set. */
static void no_buffer(void)
{
    MaskedOcclusionCulling *moc = NULL, *other = make(MOC_AVX512, MOC_UPDATE_RULE_THREE_LAYER);
    const MaskedOcclusionCulling *others[2];
    MOC_TriList list = {0, 0, NULL};
    float quad[16], out[16];
    uint32_t w = 1, h = 1;
    int32_t r = MOC_OCCLUDED;
    CHECK_EQ(MOC_Create(NULL, &moc), MOC_STATUS_OK);
    others[0] = other;
    others[1] = moc;
    quad_at(quad, -2.0f, -2.0f, 2.0f, 2.0f, 10.0f);
#define HAS_NONE(call) CHECK_EQ(call, MOC_STATUS_NO_BUFFER)
    HAS_NONE(MOC_GetResolution(moc, &w, &h));
    CHECK(w == 0 && h == 0);
    HAS_NONE(MOC_ComputeBinWidthHeight(moc, 1, 1, &w, &h));
    HAS_NONE(MOC_ClearBuffer(moc));
    HAS_NONE(MOC_MergeBuffer(moc, moc));
    HAS_NONE(MOC_MergeBuffer(moc, other));
    HAS_NONE(MOC_MergeBuffer(other, moc));
    HAS_NONE(MOC_MergeBuffers(other, others, 2));
    HAS_NONE(MOC_RecorderStart(moc, "no_buffer.mocrec"));
    HAS_NONE(MOC_RecordRenderTriangles(moc, quad, QUAD, 2, NULL, 1, 0x1f, NULL, MOC_RESULT_UNKNOWN));
    HAS_NONE(MOC_RenderTriangles(moc, quad, QUAD, 2, REST));
    CHECK_EQ(r, MOC_VISIBLE);
    HAS_NONE(MOC_RenderTriangles(moc, NULL, NULL, 0, REST));
    HAS_NONE(MOC_RenderTrianglesChecked(moc, quad, 16, QUAD, 2, REST));
    HAS_NONE(MOC_TestTriangles(moc, quad, QUAD, 2, REST));
    HAS_NONE(MOC_TestTrianglesChecked(moc, quad, 16, QUAD, 2, REST));
    HAS_NONE(MOC_BinTriangles(moc, quad, QUAD, 2, &list, 1, 1, REST));
    HAS_NONE(MOC_BinTrianglesChecked(moc, quad, 16, QUAD, 2, &list, 1, 1, REST));
    HAS_NONE(MOC_TestRect(moc, 0, 0, 1, 1, 1, &r));
    CHECK_EQ(r, MOC_VISIBLE);
    HAS_NONE(MOC_RenderTrilist(moc, &list, NULL));
    HAS_NONE(MOC_ComputePixelDepthBuffer(moc, out, 0));
    HAS_NONE(MOC_ComputePixelDepthBufferChecked(moc, out, 16, 0));
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
    CHECK_EQ(MOC_Destroy(other), MOC_STATUS_OK);
}

/* Misaligned pointers, and invalid layouts. */
static void layouts(void)
{
    const MOC_VertexLayout negative = {-16, 4, 12}, zero = {0, 4, 12}, wide = {INT_MAX, 4, 12}, back = {16, 4, -12};
    MaskedOcclusionCulling *moc = make(MOC_AVX512, MOC_UPDATE_RULE_THREE_LAYER);
    const uint32_t first[3] = {0, 0, 0};
    uint64_t words[32], list_words[8]; /* aligned, so that one byte further is misaligned */
    unsigned char *const bytes = (unsigned char *)words, *const list_bytes = (unsigned char *)list_words;
    float quad[16], out[16];
    int32_t r;
    memset(words, 0, sizeof words);
    memset(list_words, 0, sizeof list_words);
    quad_at(quad, -2.0f, -2.0f, 2.0f, 2.0f, 10.0f);
#define ANY NULL, MOC_BACKFACE_NONE, MOC_CLIP_PLANE_ALL
    CHECK_EQ(MOC_RenderTriangles(moc, quad, (uint32_t *)(void *)(bytes + 1), 2, REST), MOC_STATUS_INVALID_LAYOUT);
    CHECK_EQ(MOC_TestTriangles(moc, quad, (uint32_t *)(void *)(bytes + 2), 2, REST), MOC_STATUS_INVALID_LAYOUT);
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, (float *)(void *)(bytes + 1), 0), MOC_STATUS_INVALID_LAYOUT);
    CHECK_EQ(MOC_BinTriangles(moc, quad, QUAD, 2, (MOC_TriList *)(void *)(list_bytes + 1), 1, 1, REST),
             MOC_STATUS_INVALID_LAYOUT);
    CHECK_EQ(MOC_RenderTrilist(moc, (MOC_TriList *)(void *)(list_bytes + 1), NULL), MOC_STATUS_INVALID_LAYOUT);
    CHECK_EQ(MOC_RenderTriangles(moc, quad, QUAD, 2, ANY, &negative, &r), MOC_STATUS_INVALID_LAYOUT);
    CHECK_EQ(MOC_TestTriangles(moc, quad, QUAD, 2, ANY, &negative, &r), MOC_STATUS_INVALID_LAYOUT);
    CHECK_EQ(MOC_TransformVertices(quad, quad, out, 1, &negative), MOC_STATUS_INVALID_LAYOUT);
    CHECK_EQ(MOC_RenderTriangles(moc, quad, QUAD, 2, ANY, &zero, &r), MOC_STATUS_OK);
    CHECK_EQ(MOC_RenderTriangles(moc, quad, first, 1, ANY, &wide, &r), MOC_STATUS_OK);
    CHECK_EQ(MOC_RenderTriangles(moc, quad + 3, first, 1, ANY, &back, &r), MOC_STATUS_OK);
    CHECK_EQ(MOC_RenderTrianglesChecked(moc, quad, 16, first, 1, ANY, &wide, &r), MOC_STATUS_OK);
    CHECK_EQ(MOC_RenderTrianglesChecked(moc, quad, 16, QUAD, 2, ANY, &wide, &r), MOC_STATUS_INDEX_OUT_OF_RANGE);
    CHECK_EQ(MOC_RenderTrianglesChecked(moc, quad, 16, QUAD, 2, ANY, &negative, &r), MOC_STATUS_INVALID_LAYOUT);
    CHECK_EQ(MOC_RenderTrianglesChecked(moc, quad, 16, QUAD, 2, ANY, &back, &r), MOC_STATUS_INVALID_LAYOUT);
    CHECK_EQ(MOC_RenderTrianglesChecked(moc, quad, 0, first, 1, ANY, NULL, &r), MOC_STATUS_INDEX_OUT_OF_RANGE);
    CHECK_EQ(MOC_RenderTrianglesChecked(moc, quad, 3, first, 1, ANY, NULL, &r), MOC_STATUS_INDEX_OUT_OF_RANGE);
    CHECK_EQ(MOC_RenderTrianglesChecked(moc, quad, SIZE_MAX, QUAD, 2, ANY, NULL, &r), MOC_STATUS_OK);
    still_works(moc);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

static void rectangles(int32_t implementation)
{
    const float special[] = {0.0f, -0.0f, -1.0f, 1.0f, -0.3f, 0.7f, 1e-40f, 1e20f, -1e20f, FLT_MAX, -FLT_MAX,
                             INFINITY, -INFINITY, NAN};
    enum { N = sizeof special / sizeof *special };
    MaskedOcclusionCulling *moc = make(implementation, MOC_UPDATE_RULE_THREE_LAYER);
    float quad[16];
    int drawn, i, lies = 0, strange = 0;
    for (drawn = 0; drawn < 2; drawn++) {
        for (i = 0; i < N * N * N * N * N; i += drawn == 0 ? 7 : 5) {
            const float x0 = special[i % N], y0 = special[i / N % N], x1 = special[i / N / N % N],
                        y1 = special[i / N / N / N % N], w = special[i / N / N / N / N];
            int32_t r = -1;
            if (MOC_TestRect(moc, x0, y0, x1, y1, w, &r) != MOC_STATUS_OK)
                strange++;
            if (r != MOC_VISIBLE && r != MOC_OCCLUDED && r != MOC_VIEW_CULLED)
                strange++;
            /* Nothing is drawn, or the rectangle is not behind the wall, or its position is undefined: never hidden. */
            if (r == MOC_OCCLUDED && (drawn == 0 || !(w > 1.0f) || isnan(x0) || isnan(y0) || isnan(x1) || isnan(y1)))
                lies++;
        }
        quad_at(quad, -2.0f, -2.0f, 2.0f, 2.0f, 1.0f);
        CHECK_EQ(MOC_RenderTriangles(moc, quad, QUAD, 2, NULL, 0, MOC_CLIP_PLANE_ALL, NULL, NULL), MOC_STATUS_OK);
    }
    CHECK_EQ(lies, 0);
    CHECK_EQ(strange, 0);
    CHECK_EQ(MOC_SetNearClipPlane(moc, NAN), MOC_STATUS_INVALID_NUMBER);
    CHECK_EQ(MOC_SetNearClipPlane(moc, INFINITY), MOC_STATUS_INVALID_NUMBER);
    CHECK_EQ(MOC_SetNearClipPlane(moc, -INFINITY), MOC_STATUS_INVALID_NUMBER);
    still_works(moc);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

/* Vertices, matrices, near planes and lists with extreme numbers. */
static void strange_numbers(int32_t implementation, int32_t rule)
{
    static const float special[] = {0.0f,     -0.0f,  1.0f,    -1.0f,    0.5f,      -0.25f,   3.0f,       -7.0f,
                                    1e-45f,   1e-38f, -1e-30f, 1e-20f,   1e10f,     -1e10f,   1e20f,      -1e20f,
                                    1.1e12f,  -1e13f, FLT_MAX, -FLT_MAX, INFINITY,  -INFINITY, NAN,       16777216.0f,
                                    8160.0f,  -4096.5f, 1e-7f, 0.9999999f, 2147483648.0f, -2147483904.0f, 1e38f, 100.0f};
    enum { N_SPECIAL = sizeof special / sizeof *special, N = 50, ROUNDS = 400 };
    MaskedOcclusionCulling *moc = make(implementation, rule), *empty = make(implementation, rule);
    float *vertices = (float *)guarded_alloc(4, 16 * 3 * N);
    float *storage = (float *)guarded_alloc(4, 4 * 9 * N);
    uint32_t *indices = (uint32_t *)guarded_alloc(4, 4 * 3 * N), seed = 77;
    float matrix[16];
    MOC_TriList list = {N, 0, NULL};
    int round, i, lies = 0;
    list.data = storage;
    for (round = 0; round < ROUNDS; round++) {
        const float *m = round % 3 == 0 ? matrix : NULL;
        const int32_t winding = round % 3, planes = (int32_t)(next_random(&seed) & 0x1f);
        int32_t result = -1;
        for (i = 0; i < 16; i++)
            matrix[i] = round % 6 == 0 ? special[next_random(&seed) % N_SPECIAL] : next_unit(&seed);
        for (i = 0; i < 12 * N; i++)
            vertices[i] = next_random(&seed) % 4 == 0 ? special[next_random(&seed) % N_SPECIAL] : 5 * next_unit(&seed);
        for (i = 0; i < 3 * N; i++)
            indices[i] = next_random(&seed) % (3 * N);
        CHECK_EQ(MOC_SetNearClipPlane(moc, round % 5 == 0 ? -1e30f : round % 5 == 1 ? 1e-30f : next_unit(&seed)),
                 MOC_STATUS_OK);
        CHECK_EQ(MOC_TestTriangles(empty, vertices, indices, N, m, winding, planes, NULL, &result), MOC_STATUS_OK);
        lies += result == MOC_OCCLUDED;
        CHECK_EQ(MOC_RenderTriangles(moc, vertices, indices, N, m, winding, planes, NULL, &result), MOC_STATUS_OK);
        CHECK(result == MOC_VISIBLE || result == MOC_VIEW_CULLED);
        CHECK_EQ(MOC_TestTriangles(moc, vertices, indices, N, m, winding, planes, NULL, &result), MOC_STATUS_OK);
        list.count = 0;
        i = MOC_BinTriangles(moc, vertices, indices, N, &list, 1, 1, m, winding, planes, NULL, &result);
        CHECK(i == MOC_STATUS_OK || i == MOC_STATUS_LIST_FULL);
        CHECK(list.count <= N);
        CHECK_EQ(MOC_RenderTrilist(moc, &list, NULL), MOC_STATUS_OK);
        if (round % 10 == 9) {
            check_depth(moc);
            still_works(moc);
        }
    }
    CHECK_EQ(lies, 0);

    /* Lists that no binning produced: special numbers, then random bits. */
    for (round = 0; round < ROUNDS; round++) {
        const MOC_ScissorRect rect = {32, 16, 96, 64};
        for (i = 0; i < 9 * N; i++) {
            const uint32_t bits = next_random(&seed) << 16 ^ next_random(&seed);
            if (round % 2 == 0)
                storage[i] = special[next_random(&seed) % N_SPECIAL] * (next_random(&seed) % 2 ? 256.0f : 1.0f);
            else
                memcpy(&storage[i], &bits, 4);
        }
        list.count = N;
        CHECK_EQ(MOC_RenderTrilist(moc, &list, round % 3 == 0 ? &rect : NULL), MOC_STATUS_OK);
        if (round % 10 == 9)
            still_works(moc);
    }
    check_depth(moc);
    guarded_release(vertices, 16 * 3 * N);
    guarded_release(storage, 4 * 9 * N);
    guarded_release(indices, 4 * 3 * N);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
    CHECK_EQ(MOC_Destroy(empty), MOC_STATUS_OK);
}

int main(void)
{
    int i;
    deadline(500);
    null_pointers();
    wrong_integers();
    larger_than_memory();
    no_buffer();
    layouts();
    for (i = 0; i < N_IMPLEMENTATIONS; i++) {
        int32_t rule;
        rectangles(IMPLEMENTATIONS[i]);
        for (rule = MOC_UPDATE_RULE_THREE_LAYER; rule <= MOC_UPDATE_RULE_FOUR_LAYER; rule++)
            strange_numbers(IMPLEMENTATIONS[i], rule);
    }
    CHECK_EQ(guarded_live_blocks(), 0);
    return check_report("hostile");
}
