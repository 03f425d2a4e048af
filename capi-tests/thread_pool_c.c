/* The pool's functions and MOC_MergeBuffers from C: each with valid arguments and with invalid ones. */
#include "check.h"
#include "masked_occlusion_culling.h"

#include <math.h>

enum { W = 333, H = 77, N = 200, OTHERS = 4 };

#define REST MOC_BACKFACE_NONE, MOC_CLIP_PLANE_ALL
#define OK(call) CHECK_EQ(call, MOC_STATUS_OK)
#define IS_NULL(call) CHECK_EQ(call, MOC_STATUS_NULL_POINTER)
#define HAS_NONE(call) CHECK_EQ(call, MOC_STATUS_NO_BUFFER)

static float vertices[12 * N];
static uint32_t indices[3 * N];
static float expected[W * H], depth[W * H];

static MaskedOcclusionCulling *make(int32_t rule)
{
    MOC_Settings settings = {.size = sizeof settings};
    MaskedOcclusionCulling *moc = NULL;
    OK(MOC_DefaultSettings(&settings));
    settings.update_rule = rule;
    OK(MOC_Create(&settings, &moc));
    if (moc == NULL)
        exit(1);
    OK(MOC_SetResolution(moc, W, H));
    return moc;
}

static void draw(MaskedOcclusionCulling *moc, uint32_t seed)
{
    random_triangles(vertices, indices, N, seed);
    OK(MOC_RenderTriangles(moc, vertices, indices, N, NULL, REST, NULL, NULL));
}

/* Both have the same pixels. */
static void same(const MaskedOcclusionCulling *a, const MaskedOcclusionCulling *b)
{
    OK(MOC_ComputePixelDepthBuffer(a, expected, 0));
    OK(MOC_ComputePixelDepthBuffer(b, depth, 0));
    CHECK(memcmp(expected, depth, sizeof depth) == 0);
}

static void merge(int32_t rule)
{
    MaskedOcclusionCulling *one = make(rule), *all = make(rule), *pooled = make(rule), *bare = NULL, *wide = make(rule);
    MaskedOcclusionCulling *made[OTHERS];
    const MaskedOcclusionCulling *others[OTHERS + 1];
    MOC_Threadpool *pool = NULL;
    int i;
    OK(MOC_Create(NULL, &bare));
    OK(MOC_SetResolution(wide, W + 1, H));
    draw(one, 50);
    draw(all, 50);
    draw(pooled, 50);
    for (i = 0; i < OTHERS; i++) {
        others[i] = made[i] = make((rule + i) % 4);
        draw(made[i], (uint32_t)i);
    }
    others[OTHERS] = others[0]; /* the same again */
    OK(MOC_ThreadpoolCreate(2, 2, 2, 4, 0, &pool));
    OK(MOC_ThreadpoolSetBuffer(pool, pooled));
    OK(MOC_ThreadpoolWakeThreads(pool));
    for (i = 0; i <= OTHERS; i++)
        OK(MOC_MergeBuffer(one, others[i]));
    OK(MOC_MergeBuffers(all, others, OTHERS + 1));
    OK(MOC_ThreadpoolMergeBuffers(pool, others, OTHERS + 1));
    OK(MOC_ThreadpoolFlush(pool));
    same(one, all);
    same(one, pooled);

    /* Rejected, or without effect. */
    OK(MOC_MergeBuffers(all, NULL, 0));
    OK(MOC_ThreadpoolMergeBuffers(pool, NULL, 0));
    IS_NULL(MOC_MergeBuffers(all, NULL, 1));
    IS_NULL(MOC_MergeBuffers(NULL, others, 1));
    IS_NULL(MOC_ThreadpoolMergeBuffers(pool, NULL, 1));
    IS_NULL(MOC_ThreadpoolMergeBuffers(NULL, others, 1));
    others[1] = NULL;
    IS_NULL(MOC_MergeBuffers(all, others, 2));
    IS_NULL(MOC_ThreadpoolMergeBuffers(pool, others, 2));
    others[1] = wide;
    CHECK_EQ(MOC_MergeBuffers(all, others, 2), MOC_STATUS_SIZE_MISMATCH);
    CHECK_EQ(MOC_ThreadpoolMergeBuffers(pool, others, 2), MOC_STATUS_SIZE_MISMATCH);
    others[1] = bare;
    HAS_NONE(MOC_MergeBuffers(all, others, 2));
    HAS_NONE(MOC_MergeBuffers(bare, others, 1));
    HAS_NONE(MOC_ThreadpoolMergeBuffers(pool, others, 2));
    /* Merging with itself changes nothing. */
    others[0] = all;
    others[1] = all;
    OK(MOC_MergeBuffers(all, others, 2));
    others[0] = pooled;
    others[1] = pooled;
    OK(MOC_ThreadpoolMergeBuffers(pool, others, 2));
    OK(MOC_ThreadpoolFlush(pool));
    same(one, all);
    same(one, pooled);

    OK(MOC_ThreadpoolDestroy(pool));
    for (i = 0; i < OTHERS; i++)
        OK(MOC_Destroy(made[i]));
    OK(MOC_Destroy(wide));
    OK(MOC_Destroy(bare));
    OK(MOC_Destroy(pooled));
    OK(MOC_Destroy(all));
    OK(MOC_Destroy(one));
}

/* Draws or tests. A rejected test answers VISIBLE. */
static MOC_Status call(const MOC_Threadpool *pool, int32_t test, const float *v, const uint32_t *t, int32_t n,
                       int32_t winding, int32_t planes)
{
    int32_t r = MOC_OCCLUDED;
    MOC_Status status;
    if (!test)
        return MOC_ThreadpoolRenderTriangles(pool, v, t, n, winding, planes);
    status = MOC_ThreadpoolTestTriangles(pool, v, t, n, winding, planes, &r);
    if (status != MOC_STATUS_OK)
        CHECK_EQ(r, MOC_VISIBLE);
    return status;
}

/* Every function: first without a pool, then with other invalid arguments, then with valid ones. */
static void every_function(void)
{
    const MOC_VertexLayout layout = {16, 4, 12}, negative = {-16, 4, 12};
    const float matrix[16] = {0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0.25f, 0, 0, 1, 0, 0, 0, 0};
    const int32_t wrong[] = {-1, 3, INT32_MAX, INT32_MIN};
    MaskedOcclusionCulling *moc = make(MOC_UPDATE_RULE_THREE_LAYER), *direct = make(MOC_UPDATE_RULE_THREE_LAYER);
    MOC_Threadpool *pool = NULL, *none;
    float near_w = 0.0f, bytes[4] = {0, 0, 0, 0};
    int32_t r, test;
    size_t i;
    random_triangles(vertices, indices, N, 3);

    IS_NULL(MOC_ThreadpoolCreate(1, 1, 1, 1, 0, NULL));
    OK(MOC_ThreadpoolCreate(2, 3, 2, 4, 3, &pool));
    CHECK(pool != NULL);
    for (i = 0; i < 3; i++) {
        none = pool;
        CHECK_EQ(MOC_ThreadpoolCreate(1, i != 0, i != 1, i != 2, i, &none), MOC_STATUS_INVALID_SIZE);
        CHECK(none == NULL);
    }
    OK(MOC_ThreadpoolDestroy(NULL));
    IS_NULL(MOC_ThreadpoolWakeThreads(NULL));
    IS_NULL(MOC_ThreadpoolSuspendThreads(NULL));
    IS_NULL(MOC_ThreadpoolFlush(NULL));
    IS_NULL(MOC_ThreadpoolSetBuffer(NULL, moc));
    IS_NULL(MOC_ThreadpoolSetResolution(NULL, W, H));
    IS_NULL(MOC_ThreadpoolSetNearClipPlane(NULL, 1.0f));
    IS_NULL(MOC_ThreadpoolSetMatrix(NULL, matrix));
    IS_NULL(MOC_ThreadpoolSetVertexLayout(NULL, &layout));
    IS_NULL(MOC_ThreadpoolClearBuffer(NULL));
    IS_NULL(MOC_ThreadpoolRenderTriangles(NULL, vertices, indices, N, REST));
    IS_NULL(MOC_ThreadpoolComputePixelDepthBuffer(NULL, depth, 0));
    r = MOC_OCCLUDED;
    IS_NULL(MOC_ThreadpoolTestRect(NULL, -1, -1, 1, 1, 5, &r));
    CHECK_EQ(r, MOC_VISIBLE);
    r = MOC_OCCLUDED;
    IS_NULL(MOC_ThreadpoolTestTriangles(NULL, vertices, indices, N, REST, &r));
    CHECK_EQ(r, MOC_VISIBLE);

    /* No object. */
    r = MOC_OCCLUDED;
    OK(MOC_ThreadpoolSetBuffer(pool, NULL));
    HAS_NONE(MOC_ThreadpoolSetResolution(pool, W, H));
    HAS_NONE(MOC_ThreadpoolClearBuffer(pool));
    HAS_NONE(MOC_ThreadpoolRenderTriangles(pool, vertices, indices, N, REST));
    HAS_NONE(MOC_ThreadpoolMergeBuffers(pool, NULL, 0));
    HAS_NONE(MOC_ThreadpoolComputePixelDepthBuffer(pool, depth, 0));
    HAS_NONE(MOC_ThreadpoolTestRect(pool, -1, -1, 1, 1, 5, &r));
    CHECK_EQ(r, MOC_VISIBLE);
    r = MOC_OCCLUDED;
    HAS_NONE(MOC_ThreadpoolTestTriangles(pool, vertices, indices, N, REST, &r));
    CHECK_EQ(r, MOC_VISIBLE);
    OK(MOC_ThreadpoolFlush(pool));

    /* An object, and invalid arguments. */
    OK(MOC_ThreadpoolSetBuffer(pool, moc));
    OK(MOC_ThreadpoolWakeThreads(pool));
    CHECK_EQ(MOC_ThreadpoolSetResolution(pool, 0, H), MOC_STATUS_INVALID_SIZE);
    CHECK_EQ(MOC_ThreadpoolSetResolution(pool, W, 16385), MOC_STATUS_INVALID_SIZE);
    CHECK_EQ(MOC_ThreadpoolSetNearClipPlane(pool, NAN), MOC_STATUS_INVALID_NUMBER);
    CHECK_EQ(MOC_ThreadpoolSetNearClipPlane(pool, INFINITY), MOC_STATUS_INVALID_NUMBER);
    CHECK_EQ(MOC_ThreadpoolSetVertexLayout(pool, &negative), MOC_STATUS_INVALID_LAYOUT);
    for (test = 0; test < 2; test++) {
        const float *v = vertices;
        const uint32_t *t = indices, *odd = (const uint32_t *)(const void *)((const char *)bytes + 1);
        IS_NULL(call(pool, test, NULL, t, N, REST));
        IS_NULL(call(pool, test, v, NULL, N, REST));
        CHECK_EQ(call(pool, test, v, t, -1, REST), MOC_STATUS_INVALID_SIZE);
        CHECK_EQ(call(pool, test, v, t, INT32_MIN, REST), MOC_STATUS_INVALID_SIZE);
        CHECK_EQ(call(pool, test, v, odd, 1, REST), MOC_STATUS_INVALID_LAYOUT);
        for (i = 0; i < sizeof wrong / sizeof *wrong; i++)
            CHECK_EQ(call(pool, test, v, t, N, wrong[i], MOC_CLIP_PLANE_ALL), MOC_STATUS_INVALID_ENUM);
        CHECK_EQ(call(pool, test, v, t, N, MOC_BACKFACE_NONE, 0x20), MOC_STATUS_INVALID_ENUM);
        OK(call(pool, test, NULL, NULL, 0, REST));
    }
    IS_NULL(MOC_ThreadpoolTestRect(pool, -1, -1, 1, 1, 5, NULL));
    IS_NULL(MOC_ThreadpoolComputePixelDepthBuffer(pool, NULL, 0));
    CHECK_EQ(MOC_ThreadpoolComputePixelDepthBuffer(pool, depth, 2), MOC_STATUS_INVALID_ENUM);
    CHECK_EQ(MOC_ThreadpoolComputePixelDepthBuffer(pool, (float *)(void *)((char *)bytes + 1), 0),
             MOC_STATUS_INVALID_LAYOUT);
    OK(MOC_ThreadpoolFlush(pool));
    same(direct, moc); /* nothing was drawn */
    OK(MOC_GetNearClipPlane(moc, &near_w));
    CHECK(near_w == 0.0f);

    /* The same calls on the pool and on an object. */
    OK(MOC_ThreadpoolSetNearClipPlane(pool, 4.0f));
    OK(MOC_ThreadpoolSetVertexLayout(pool, &layout));
    OK(MOC_ThreadpoolRenderTriangles(pool, vertices, indices, N, REST));
    OK(MOC_ThreadpoolSetResolution(pool, W, H));
    OK(MOC_ThreadpoolRenderTriangles(pool, vertices, indices, N, REST));
    OK(MOC_ThreadpoolClearBuffer(pool));
    OK(MOC_ThreadpoolSetMatrix(pool, matrix));
    OK(MOC_ThreadpoolRenderTriangles(pool, vertices, indices, N, REST));
    OK(MOC_ThreadpoolSuspendThreads(pool));
    OK(MOC_ThreadpoolSetMatrix(pool, NULL));
    OK(MOC_ThreadpoolSetVertexLayout(pool, NULL));
    OK(MOC_ThreadpoolRenderTriangles(pool, vertices, indices, N / 2, REST));
    OK(MOC_ThreadpoolFlush(pool));
    OK(MOC_SetNearClipPlane(direct, 4.0f));
    OK(MOC_RenderTriangles(direct, vertices, indices, N, matrix, REST, &layout, NULL));
    OK(MOC_RenderTriangles(direct, vertices, indices, N / 2, NULL, REST, NULL, NULL));
    same(direct, moc);
    for (i = 0; i < 2; i++) {
        OK(MOC_ComputePixelDepthBuffer(direct, expected, (int32_t)i));
        OK(MOC_ThreadpoolComputePixelDepthBuffer(pool, depth, (int32_t)i));
        CHECK(memcmp(expected, depth, sizeof depth) == 0);
    }
    OK(MOC_GetNearClipPlane(moc, &near_w));
    CHECK(near_w == 4.0f);
    for (i = 0; i < N; i++) {
        const float x = vertices[12 * i] / 9.0f, y = vertices[12 * i + 1] / 9.0f;
        int32_t should = -1;
        r = -1;
        OK(MOC_TestRect(direct, x, y, x + 0.1f, y + 0.1f, 9, &should));
        OK(MOC_ThreadpoolTestRect(pool, x, y, x + 0.1f, y + 0.1f, 9, &r));
        CHECK_EQ(r, should);
        OK(MOC_TestTriangles(direct, vertices, indices + 3 * i, 1, NULL, REST, NULL, &should));
        OK(MOC_ThreadpoolTestTriangles(pool, vertices, indices + 3 * i, 1, REST, &r));
        CHECK_EQ(r, should);
    }
    OK(MOC_ThreadpoolRenderTriangles(pool, vertices, indices, N, REST));
    OK(MOC_ThreadpoolDestroy(pool));
    OK(MOC_Destroy(moc));
    OK(MOC_Destroy(direct));
}

int main(void)
{
    int32_t rule;
    for (rule = MOC_UPDATE_RULE_THREE_LAYER; rule <= MOC_UPDATE_RULE_FOUR_LAYER; rule++)
        merge(rule);
    every_function();
    return check_report("thread_pool_c");
}
