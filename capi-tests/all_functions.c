/* Every function of the C interface, with every implementation and update rule. Those of the pool are in
 * thread_pool_c.c. */
#include "check.h"
#include "masked_occlusion_culling.h"

enum { W = 256, H = 136 };

static MaskedOcclusionCulling *make(int32_t implementation, int32_t rule, int32_t y_axis)
{
    MOC_Settings settings = {.size = sizeof settings};
    MaskedOcclusionCulling *moc = NULL;
    CHECK_EQ(MOC_DefaultSettings(&settings), MOC_STATUS_OK);
    CHECK_EQ(settings.implementation, MOC_AVX512);
    CHECK_EQ(settings.update_rule, MOC_UPDATE_RULE_THREE_LAYER);
    CHECK_EQ(settings.y_axis, MOC_Y_AXIS_DOWN);
    CHECK_EQ(settings.size, sizeof settings);
    CHECK_EQ(settings.statistics, 0);
    CHECK(settings.alloc == NULL && settings.free == NULL);
    settings.statistics = 1;
    settings.implementation = implementation;
    settings.update_rule = rule;
    settings.y_axis = y_axis;
    CHECK_EQ(MOC_Create(&settings, &moc), MOC_STATUS_OK);
    CHECK(moc != NULL);
    if (moc == NULL)
        exit(1);
    return moc;
}

static int32_t render(MaskedOcclusionCulling *moc, const float *quad)
{
    int32_t result = -1;
    CHECK_EQ(MOC_RenderTriangles(moc, quad, QUAD, 2, NULL, MOC_BACKFACE_CW, MOC_CLIP_PLANE_ALL, NULL, &result),
             MOC_STATUS_OK);
    return result;
}

static int32_t test(const MaskedOcclusionCulling *moc, const float *quad)
{
    int32_t result = -1;
    CHECK_EQ(MOC_TestTriangles(moc, quad, QUAD, 2, NULL, MOC_BACKFACE_CW, MOC_CLIP_PLANE_ALL, NULL, &result),
             MOC_STATUS_OK);
    return result;
}

static int32_t test_rect(const MaskedOcclusionCulling *moc, float xmin, float ymin, float xmax, float ymax, float w)
{
    int32_t result = -1;
    CHECK_EQ(MOC_TestRect(moc, xmin, ymin, xmax, ymax, w, &result), MOC_STATUS_OK);
    return result;
}

/* How many pixels of the depth buffer are not empty, in rows first to last - 1. */
static int covered(const float *depth, int first, int last)
{
    int i, n = 0;
    for (i = first * W; i < last * W; i++)
        n += depth[i] >= 0.0f;
    return n;
}

static void versions(void)
{
    int32_t status;
    CHECK_EQ(MOC_GetAbiVersion(), MOC_ABI_VERSION);
    for (status = -2; status < 20; status++) {
        const char *text = MOC_StatusText(status);
        CHECK(text != NULL && text[0] != '\0');
        if (status > MOC_STATUS_OK && status <= MOC_STATUS_INTERNAL)
            CHECK(strcmp(text, MOC_StatusText(status - 1)) != 0);
    }
    CHECK(strcmp(MOC_StatusText(-1), MOC_StatusText(99)) == 0);
}

static void properties(int32_t rule)
{
    MaskedOcclusionCulling *moc = make(MOC_SCALAR, rule, MOC_Y_AXIS_DOWN);
    uint32_t w = 7, h = 7;
    int32_t value = -7;
    float near_w = -1.0f;
    CHECK_EQ(MOC_GetResolution(moc, &w, &h), MOC_STATUS_NO_BUFFER);
    CHECK(w == 0 && h == 0);
    CHECK_EQ(MOC_SetResolution(moc, 1, 1), MOC_STATUS_OK);
    CHECK_EQ(MOC_SetResolution(moc, 16384, 1), MOC_STATUS_OK);
    CHECK_EQ(MOC_SetResolution(moc, W, H), MOC_STATUS_OK);
    CHECK_EQ(MOC_GetResolution(moc, &w, &h), MOC_STATUS_OK);
    CHECK(w == W && h == H);
    CHECK_EQ(MOC_ComputeBinWidthHeight(moc, 3, 2, &w, &h), MOC_STATUS_OK);
    CHECK_EQ(w, 64);
    CHECK_EQ(h, 64);
    CHECK_EQ(MOC_GetNearClipPlane(moc, &near_w), MOC_STATUS_OK);
    CHECK(near_w == 0.0f);
    CHECK_EQ(MOC_SetNearClipPlane(moc, 0.25f), MOC_STATUS_OK);
    CHECK_EQ(MOC_GetNearClipPlane(moc, &near_w), MOC_STATUS_OK);
    CHECK(near_w == 0.25f);
    CHECK_EQ(MOC_GetImplementation(moc, &value), MOC_STATUS_OK);
    CHECK_EQ(value, SIMPLEST_IMPLEMENTATION);
    CHECK_EQ(MOC_GetUpdateRule(moc, &value), MOC_STATUS_OK);
    CHECK_EQ(value, rule);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
    CHECK_EQ(MOC_Destroy(NULL), MOC_STATUS_OK);
}

static void wall(int32_t implementation, int32_t rule, int32_t y_axis)
{
    static float depth[W * H], flipped[W * H];
    MaskedOcclusionCulling *moc = make(implementation, rule, y_axis);
    MOC_Statistics stats = {.size = sizeof stats};
    int64_t dropped = -1;
    float quad[16];
    int y;
    CHECK_EQ(MOC_SetResolution(moc, W, H), MOC_STATUS_OK);

    /* Nothing has been drawn, so nothing is hidden. */
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, depth, 0), MOC_STATUS_OK);
    CHECK_EQ(covered(depth, 0, H), 0);
    CHECK_EQ(test_rect(moc, -0.5f, -0.5f, 0.5f, 0.5f, 100.0f), MOC_VISIBLE);
    quad_at(quad, -0.5f, -0.5f, 0.5f, 0.5f, 100.0f);
    CHECK_EQ(test(moc, quad), MOC_VISIBLE);

    /* The upper half of the view, 10 away. */
    quad_at(quad, -2.0f, 0.0f, 2.0f, 2.0f, 10.0f);
    CHECK_EQ(render(moc, quad), MOC_VISIBLE);
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, depth, 0), MOC_STATUS_OK);
    CHECK_EQ(MOC_ComputePixelDepthBufferChecked(moc, flipped, W * H, 1), MOC_STATUS_OK);
    CHECK_EQ(MOC_ComputePixelDepthBufferChecked(moc, flipped, W * H - 1, 1), MOC_STATUS_INVALID_SIZE);
    if (y_axis == MOC_Y_AXIS_DOWN) {
        CHECK_EQ(covered(depth, 0, H / 2), W * H / 2);
        CHECK_EQ(covered(depth, H / 2, H), 0);
    } else {
        CHECK_EQ(covered(depth, 0, H / 2), 0);
        CHECK_EQ(covered(depth, H / 2, H), W * H / 2);
    }
    for (y = 0; y < H; y++)
        CHECK(memcmp(depth + y * W, flipped + (H - 1 - y) * W, W * sizeof(float)) == 0);

    CHECK_EQ(test_rect(moc, -0.5f, 0.25f, 0.5f, 0.5f, 20.0f), MOC_OCCLUDED);
    CHECK_EQ(test_rect(moc, -0.5f, 0.25f, 0.5f, 0.5f, 5.0f), MOC_VISIBLE);
    CHECK_EQ(test_rect(moc, -0.5f, -0.5f, 0.5f, 0.5f, 20.0f), MOC_VISIBLE);
    CHECK_EQ(test_rect(moc, 1.5f, -0.5f, 2.5f, 0.5f, 20.0f), MOC_VIEW_CULLED);
    quad_at(quad, -0.5f, 0.25f, 0.5f, 0.5f, 20.0f);
    CHECK_EQ(test(moc, quad), MOC_OCCLUDED);
    quad_at(quad, -0.5f, 0.25f, 0.5f, 0.5f, 5.0f);
    CHECK_EQ(test(moc, quad), MOC_VISIBLE);
    quad_at(quad, 3.0f, 0.25f, 4.0f, 0.5f, 5.0f);
    CHECK_EQ(test(moc, quad), MOC_VIEW_CULLED);
    CHECK_EQ(render(moc, quad), MOC_VIEW_CULLED);

    CHECK_EQ(MOC_GetStatistics(moc, &stats), MOC_STATUS_OK);
    CHECK_EQ(stats.occluders.num_processed_triangles, 4);
    CHECK_EQ(stats.occluders.num_rasterized_triangles, 2);
    CHECK_EQ(MOC_GetDroppedTriangles(moc, &dropped), MOC_STATUS_OK);
    CHECK_EQ(dropped, 0);
    CHECK_EQ(stats.occludees.num_processed_rectangles, 5);
    CHECK_EQ(stats.occludees.num_processed_triangles, 8);

    CHECK_EQ(MOC_ClearBuffer(moc), MOC_STATUS_OK);
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, depth, 0), MOC_STATUS_OK);
    CHECK_EQ(covered(depth, 0, H), 0);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

/* The same quad through different layouts, with and without a matrix, gives the same bits. */
static void layouts(int32_t implementation)
{
    static float expected[W * H], depth[W * H];
    /* x' = x, y' = y, w' = z */
    const float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0};
    const MOC_VertexLayout packed = {12, 4, 8}, padded = {16, 4, 8}, arrays = {4, 16, 32}, backwards = {12, -4, -8};
    const MOC_VertexLayout clip = {16, 4, 12};
    float quad[16], three[12], four[16], soa[12], swapped[12];
    unsigned char unaligned[65];
    MaskedOcclusionCulling *moc = make(implementation, MOC_UPDATE_RULE_THREE_LAYER, MOC_Y_AXIS_DOWN);
    int i, k;
    CHECK_EQ(MOC_SetResolution(moc, W, H), MOC_STATUS_OK);
    quad_at(quad, -0.7f, -0.6f, 0.8f, 0.5f, 3.0f);
    quad[3] = 2.5f;
    render(moc, quad);
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, expected, 0), MOC_STATUS_OK);
    CHECK(covered(expected, 0, H) > W * H / 8);
    for (i = 0; i < 4; i++) {
        const float x = quad[4 * i], y = quad[4 * i + 1], w = quad[4 * i + 3];
        three[3 * i] = x, three[3 * i + 1] = y, three[3 * i + 2] = w;
        four[4 * i] = x, four[4 * i + 1] = y, four[4 * i + 2] = w, four[4 * i + 3] = -1.0f;
        soa[i] = x, soa[4 + i] = y, soa[8 + i] = w;
        swapped[3 * i] = w, swapped[3 * i + 1] = y, swapped[3 * i + 2] = x;
    }
    memcpy(unaligned + 1, quad, sizeof quad);
    for (k = 0; k < 9; k++) {
        const float *vertices[] = {three, four, soa, swapped + 2, three, four, soa, quad, (float *)(void *)(unaligned + 1)};
        const MOC_VertexLayout *layout[] = {&packed, &padded, &arrays, &backwards, &packed, &padded, &arrays, &clip, NULL};
        const float *m = k < 4 ? matrix : NULL;
        int32_t result = -1;
        MOC_ClearBuffer(moc);
        CHECK_EQ(MOC_RenderTriangles(moc, vertices[k], QUAD, 2, m, MOC_BACKFACE_CW, MOC_CLIP_PLANE_ALL, layout[k],
                                     &result), MOC_STATUS_OK);
        CHECK_EQ(result, MOC_VISIBLE);
        CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, depth, 0), MOC_STATUS_OK);
        if (memcmp(depth, expected, sizeof depth) != 0) {
            fprintf(stderr, "layout %d on implementation %d draws something else\n", k, (int)implementation);
            check_failures++;
        }
    }

    /* Back faces. */
    for (k = MOC_BACKFACE_NONE; k <= MOC_BACKFACE_CCW; k++) {
        const int32_t should = k == MOC_BACKFACE_CCW ? MOC_VIEW_CULLED : MOC_VISIBLE;
        int32_t result = -1;
        MOC_ClearBuffer(moc);
        CHECK_EQ(MOC_TestTriangles(moc, quad, QUAD, 2, NULL, k, MOC_CLIP_PLANE_ALL, NULL, &result), MOC_STATUS_OK);
        CHECK_EQ(result, should);
        CHECK_EQ(MOC_RenderTriangles(moc, quad, QUAD, 2, NULL, k, MOC_CLIP_PLANE_ALL, NULL, &result), MOC_STATUS_OK);
        CHECK_EQ(result, should);
    }
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

static void checked(int32_t implementation)
{
    static float depth[W * H];
    const MOC_VertexLayout negative = {16, -4, 12};
    const uint32_t bad[6] = {0, 1, 2, 0, 4, 3};
    float quad[16], storage[9 * 4];
    MOC_TriList list = {4, 0, NULL};
    MaskedOcclusionCulling *moc = make(implementation, MOC_UPDATE_RULE_THREE_LAYER, MOC_Y_AXIS_DOWN);
    int32_t result = -1;
    list.data = storage;
    CHECK_EQ(MOC_SetResolution(moc, W, H), MOC_STATUS_OK);
    quad_at(quad, -2.0f, -2.0f, 2.0f, 2.0f, 10.0f);
#define REST NULL, MOC_BACKFACE_CW, MOC_CLIP_PLANE_ALL, NULL, &result
    CHECK_EQ(MOC_RenderTrianglesChecked(moc, quad, 16, bad, 2, REST), MOC_STATUS_INDEX_OUT_OF_RANGE);
    CHECK_EQ(result, MOC_VISIBLE);
    CHECK_EQ(MOC_RenderTrianglesChecked(moc, quad, 15, QUAD, 2, REST), MOC_STATUS_INDEX_OUT_OF_RANGE);
    CHECK_EQ(MOC_TestTrianglesChecked(moc, quad, 16, bad, 2, REST), MOC_STATUS_INDEX_OUT_OF_RANGE);
    CHECK_EQ(MOC_BinTrianglesChecked(moc, quad, 16, bad, 2, &list, 1, 1, REST), MOC_STATUS_INDEX_OUT_OF_RANGE);
    CHECK_EQ(list.count, 0);
    CHECK_EQ(MOC_RenderTrianglesChecked(moc, quad, 16, QUAD, 2, NULL, 1, 0x1f, &negative, &result),
             MOC_STATUS_INVALID_LAYOUT);
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, depth, 0), MOC_STATUS_OK);
    CHECK_EQ(covered(depth, 0, H), 0);

    CHECK_EQ(MOC_BinTrianglesChecked(moc, quad, 16, QUAD, 2, &list, 1, 1, REST), MOC_STATUS_OK);
    CHECK_EQ(result, MOC_VISIBLE);
    CHECK_EQ(list.count, 2);
    CHECK_EQ(MOC_TestTrianglesChecked(moc, quad, 16, QUAD, 2, REST), MOC_STATUS_OK);
    CHECK_EQ(result, MOC_VISIBLE);
    CHECK_EQ(MOC_RenderTrianglesChecked(moc, quad, 16, QUAD, 2, REST), MOC_STATUS_OK);
    CHECK_EQ(result, MOC_VISIBLE);
#undef REST
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, depth, 0), MOC_STATUS_OK);
    CHECK_EQ(covered(depth, 0, H), W * H);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

/* A mesh passed as a struct gives the same bits and answers as the same arguments passed individually. */
static void meshes(int32_t implementation)
{
    static float expected[W * H], depth[W * H];
    /* x' = x, y' = y, w' = z */
    const float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0};
    const MOC_VertexLayout backwards = {12, -4, -8};
    const uint32_t bad[6] = {0, 1, 2, 0, 4, 3};
    MOC_Mesh mesh = {.size = sizeof mesh}, wrong;
    float quad[16], three[12], swapped[12], storage[9 * 4];
    MOC_TriList list = {4, 0, NULL};
    MaskedOcclusionCulling *moc = make(implementation, MOC_UPDATE_RULE_THREE_LAYER, MOC_Y_AXIS_DOWN);
    int32_t result = -1;
    int i;
    list.data = storage;
    quad_at(quad, -0.7f, -0.6f, 0.8f, 0.5f, 3.0f);
    for (i = 0; i < 4; i++) {
        three[3 * i] = swapped[3 * i + 2] = quad[4 * i];
        three[3 * i + 1] = swapped[3 * i + 1] = quad[4 * i + 1];
        three[3 * i + 2] = swapped[3 * i] = quad[4 * i + 3];
    }
    mesh.vertices = quad;
    mesh.vertex_count = 4;
    mesh.indices = QUAD;
    mesh.triangle_count = 2;
    mesh.winding = MOC_BACKFACE_CW;
    mesh.clip_planes = MOC_CLIP_PLANE_ALL;
    CHECK_EQ(MOC_RenderMesh(moc, &mesh, &result), MOC_STATUS_NO_BUFFER);
    CHECK_EQ(MOC_TestMesh(moc, &mesh, &result), MOC_STATUS_NO_BUFFER);
    CHECK_EQ(MOC_BinMesh(moc, &mesh, &list, 1, 1, &result), MOC_STATUS_NO_BUFFER);
    CHECK_EQ(MOC_RecordMesh(moc, &mesh, MOC_RESULT_UNKNOWN), MOC_STATUS_NO_BUFFER);
    CHECK_EQ(MOC_SetResolution(moc, W, H), MOC_STATUS_OK);
    render(moc, quad);
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, expected, 0), MOC_STATUS_OK);
    for (i = 0; i < 4; i++) {
        /* Packed x, y, z, w without a matrix; packed x, y, z with one; another layout, whose offsets may be negative although
         * the number of vertices is given; and one whose number is not. */
        if (i >= 1) {
            mesh.model_to_clip = matrix;
            mesh.vertices = three;
        }
        if (i >= 2) {
            mesh.layout = &backwards;
            mesh.vertices = swapped + 2;
        }
        if (i >= 3) {
            mesh.vertex_count = MOC_UNCHECKED;
            mesh.index_size = 4;
        }
        MOC_ClearBuffer(moc);
        CHECK_EQ(MOC_TestMesh(moc, &mesh, &result), MOC_STATUS_OK);
        CHECK_EQ(result, MOC_VISIBLE);
        CHECK_EQ(MOC_RenderMesh(moc, &mesh, &result), MOC_STATUS_OK);
        CHECK_EQ(result, MOC_VISIBLE);
        CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, depth, 0), MOC_STATUS_OK);
        CHECK(memcmp(depth, expected, sizeof depth) == 0);
        MOC_ClearBuffer(moc);
        list.count = 0;
        CHECK_EQ(MOC_BinMesh(moc, &mesh, &list, 1, 1, NULL), MOC_STATUS_OK);
        CHECK_EQ(MOC_RenderTrilist(moc, &list, NULL), MOC_STATUS_OK);
        CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, depth, 0), MOC_STATUS_OK);
        CHECK(memcmp(depth, expected, sizeof depth) == 0);
        CHECK_EQ(MOC_RecordMesh(moc, &mesh, MOC_RESULT_UNKNOWN), MOC_STATUS_OK);
        mesh.winding = MOC_BACKFACE_CCW;
        CHECK_EQ(MOC_TestMesh(moc, &mesh, &result), MOC_STATUS_OK);
        CHECK_EQ(result, MOC_VIEW_CULLED);
        mesh.winding = MOC_BACKFACE_CW;
    }

    MOC_ClearBuffer(moc);
    list.count = 0;
    for (i = 0; i < 10; i++) {
        const int32_t status[] = {MOC_STATUS_INVALID_SIZE, MOC_STATUS_INVALID_SIZE, MOC_STATUS_INVALID_ENUM,
                                  MOC_STATUS_INVALID_SIZE, MOC_STATUS_NULL_POINTER, MOC_STATUS_NULL_POINTER,
                                  MOC_STATUS_INDEX_OUT_OF_RANGE, MOC_STATUS_INDEX_OUT_OF_RANGE,
                                  MOC_STATUS_INVALID_ENUM, MOC_STATUS_INVALID_ENUM};
        wrong = mesh;
        wrong.vertex_count = 4;
        switch (i) {
        case 0: wrong.size = 0; break;
        case 1: wrong.size = sizeof wrong - 1; break;
        case 2: wrong.index_size = 2; break;
        case 3: wrong.triangle_count = 0x80000000u; break;
        case 4: wrong.vertices = NULL; break;
        case 5: wrong.indices = NULL; break;
        case 6: wrong.indices = bad; break;
        case 7: wrong.vertex_count = 3; break;
        case 8: wrong.winding = 3; break;
        case 9: wrong.clip_planes = 0x20; break;
        }
        result = MOC_OCCLUDED;
        CHECK_EQ(MOC_RenderMesh(moc, &wrong, &result), status[i]);
        CHECK_EQ(result, MOC_VISIBLE);
        CHECK_EQ(MOC_TestMesh(moc, &wrong, &result), status[i]);
        CHECK_EQ(MOC_BinMesh(moc, &wrong, &list, 1, 1, &result), status[i]);
        CHECK_EQ(MOC_RecordMesh(moc, &wrong, MOC_RESULT_UNKNOWN), status[i]);
    }
    CHECK_EQ(list.count, 0);
    CHECK_EQ(MOC_RenderMesh(moc, NULL, &result), MOC_STATUS_NULL_POINTER);
    CHECK_EQ(MOC_RecordMesh(moc, &mesh, 2), MOC_STATUS_INVALID_ENUM);
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, depth, 0), MOC_STATUS_OK);
    CHECK_EQ(covered(depth, 0, H), 0);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

/* Structs smaller than the library's are rejected; in larger ones it writes the fields that it knows. */
static void sizes(void)
{
    struct {
        MOC_Settings settings;
        char more[16];
    } later = {.settings = {.size = sizeof later}};
    struct {
        MOC_Statistics statistics;
        int64_t more;
    } counted = {.statistics = {.size = sizeof counted}, .more = -77};
    MOC_Settings settings = {.size = sizeof settings - 1};
    MOC_Statistics statistics = {.size = 72};
    MaskedOcclusionCulling *moc = NULL;
    CHECK_EQ(MOC_DefaultSettings(&settings), MOC_STATUS_INVALID_SIZE);
    CHECK_EQ(settings.implementation, 0);
    CHECK_EQ(MOC_Create(&settings, &moc), MOC_STATUS_INVALID_SIZE);
    CHECK(moc == NULL);
    memset(later.more, 7, sizeof later.more);
    CHECK_EQ(MOC_DefaultSettings(&later.settings), MOC_STATUS_OK);
    CHECK_EQ(later.settings.size, sizeof later);
    CHECK(later.more[0] == 7 && later.more[15] == 7);
    CHECK_EQ(MOC_Create(&later.settings, &moc), MOC_STATUS_OK);
    CHECK_EQ(MOC_GetStatistics(moc, &statistics), MOC_STATUS_INVALID_SIZE);
    CHECK_EQ(MOC_GetStatistics(moc, &counted.statistics), MOC_STATUS_OK);
    CHECK_EQ(counted.statistics.size, sizeof counted);
    CHECK_EQ(counted.more, -77);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

static void bins(int32_t implementation, int32_t rule, int32_t y_axis)
{
    enum { N = 300, BINS_W = 3, BINS_H = 2 };
    static float vertices[12 * N], direct[W * H], binned[W * H], storage[BINS_W * BINS_H][9 * 2 * N];
    static uint32_t indices[3 * N];
    MOC_TriList lists[BINS_W * BINS_H];
    MaskedOcclusionCulling *moc = make(implementation, rule, y_axis);
    uint32_t bin_w = 0, bin_h = 0;
    int32_t result = -1;
    int x, y, i, total = 0;
    random_triangles(vertices, indices, N, 1234);
    CHECK_EQ(MOC_SetResolution(moc, W, H), MOC_STATUS_OK);
    CHECK_EQ(MOC_RenderTriangles(moc, vertices, indices, N, NULL, MOC_BACKFACE_NONE, MOC_CLIP_PLANE_ALL, NULL, NULL),
             MOC_STATUS_OK);
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, direct, 0), MOC_STATUS_OK);
    CHECK(covered(direct, 0, H) > W * H / 4);

    for (i = 0; i < BINS_W * BINS_H; i++) {
        lists[i].capacity = 2 * N;
        lists[i].count = 0;
        lists[i].data = storage[i];
    }
    MOC_ClearBuffer(moc);
    CHECK_EQ(MOC_ComputeBinWidthHeight(moc, BINS_W, BINS_H, &bin_w, &bin_h), MOC_STATUS_OK);
    CHECK_EQ(MOC_BinTriangles(moc, vertices, indices, N, lists, BINS_W, BINS_H, NULL, MOC_BACKFACE_NONE,
                              MOC_CLIP_PLANE_ALL, NULL, &result), MOC_STATUS_OK);
    CHECK_EQ(result, MOC_VISIBLE);
    for (y = BINS_H - 1; y >= 0; y--) {
        for (x = 0; x < BINS_W; x++) {
            MOC_ScissorRect rect;
            rect.min_x = x * (int)bin_w;
            rect.min_y = y * (int)bin_h;
            rect.max_x = x == BINS_W - 1 ? W : rect.min_x + (int)bin_w;
            rect.max_y = y == BINS_H - 1 ? H : rect.min_y + (int)bin_h;
            total += (int)lists[y * BINS_W + x].count;
            CHECK_EQ(MOC_RenderTrilist(moc, &lists[y * BINS_W + x], &rect), MOC_STATUS_OK);
        }
    }
    CHECK(total >= N / 4);
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, binned, 0), MOC_STATUS_OK);
    CHECK(memcmp(direct, binned, sizeof direct) == 0);

    /* One bin, drawn without a scissor rectangle. */
    lists[0].count = 0;
    MOC_ClearBuffer(moc);
    CHECK_EQ(MOC_BinTriangles(moc, vertices, indices, N, lists, 1, 1, NULL, MOC_BACKFACE_NONE, MOC_CLIP_PLANE_ALL,
                              NULL, NULL), MOC_STATUS_OK);
    CHECK_EQ(MOC_RenderTrilist(moc, &lists[0], NULL), MOC_STATUS_OK);
    CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, binned, 0), MOC_STATUS_OK);
    CHECK(memcmp(direct, binned, sizeof direct) == 0);

    /* A full list takes no more triangles, and the call reports it. */
    lists[0].count = 0;
    lists[0].capacity = 3;
    CHECK_EQ(MOC_BinTriangles(moc, vertices, indices, N, lists, 1, 1, NULL, MOC_BACKFACE_NONE, MOC_CLIP_PLANE_ALL,
                              NULL, &result), MOC_STATUS_LIST_FULL);
    CHECK_EQ(lists[0].count, 3);
    CHECK_EQ(result, MOC_VISIBLE);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

static void merge(int32_t implementation, int32_t rule)
{
    MaskedOcclusionCulling *left = make(implementation, rule, MOC_Y_AXIS_DOWN);
    MaskedOcclusionCulling *right = make(MOC_SCALAR, MOC_UPDATE_RULE_THREE_LAYER, MOC_Y_AXIS_DOWN);
    MaskedOcclusionCulling *up = make(MOC_SCALAR, MOC_UPDATE_RULE_THREE_LAYER, MOC_Y_AXIS_UP);
    float quad[16];
    CHECK_EQ(MOC_MergeBuffer(left, left), MOC_STATUS_NO_BUFFER);
    CHECK_EQ(MOC_SetResolution(left, W, H), MOC_STATUS_OK);
    CHECK_EQ(MOC_MergeBuffer(left, right), MOC_STATUS_NO_BUFFER);
    CHECK_EQ(MOC_SetResolution(right, W, H + 8), MOC_STATUS_OK);
    CHECK_EQ(MOC_MergeBuffer(left, right), MOC_STATUS_SIZE_MISMATCH);
    CHECK_EQ(MOC_SetResolution(right, W, H), MOC_STATUS_OK);
    CHECK_EQ(MOC_SetResolution(up, W, H), MOC_STATUS_OK);
    CHECK_EQ(MOC_MergeBuffer(left, up), MOC_STATUS_SIZE_MISMATCH);
    quad_at(quad, -1.5f, -1.5f, 0.0f, 1.5f, 10.0f);
    render(left, quad);
    quad_at(quad, 0.0f, -1.5f, 1.5f, 1.5f, 12.0f);
    render(right, quad);
    CHECK_EQ(test_rect(left, -0.5f, -0.5f, 0.5f, 0.5f, 30.0f), MOC_VISIBLE);
    CHECK_EQ(MOC_MergeBuffer(left, right), MOC_STATUS_OK);
    CHECK_EQ(test_rect(left, -0.5f, -0.5f, 0.5f, 0.5f, 30.0f), MOC_OCCLUDED);
    CHECK_EQ(test_rect(left, 0.1f, -0.5f, 0.5f, 0.5f, 11.0f), MOC_VISIBLE);
    CHECK_EQ(test_rect(right, -0.5f, -0.5f, 0.5f, 0.5f, 30.0f), MOC_VISIBLE);
    CHECK_EQ(MOC_MergeBuffer(left, left), MOC_STATUS_OK);
    CHECK_EQ(test_rect(left, -0.5f, -0.5f, 0.5f, 0.5f, 30.0f), MOC_OCCLUDED);
    CHECK_EQ(test_rect(left, -0.5f, -0.5f, 0.5f, 0.5f, 9.0f), MOC_VISIBLE);
    {
        const MaskedOcclusionCulling *others[2];
        others[0] = right;
        others[1] = left;
        CHECK_EQ(MOC_MergeBuffers(up, others, 2), MOC_STATUS_SIZE_MISMATCH);
        CHECK_EQ(MOC_MergeBuffers(left, others, 2), MOC_STATUS_OK);
        CHECK_EQ(MOC_MergeBuffers(left, others, 1), MOC_STATUS_OK);
        CHECK_EQ(test_rect(left, -0.5f, -0.5f, 0.5f, 0.5f, 30.0f), MOC_OCCLUDED);
        CHECK_EQ(test_rect(left, 0.1f, -0.5f, 0.5f, 0.5f, 11.0f), MOC_VISIBLE);
    }
    MOC_Destroy(left);
    MOC_Destroy(right);
    MOC_Destroy(up);
}

static void near_plane(int32_t implementation)
{
    MaskedOcclusionCulling *moc = make(implementation, MOC_UPDATE_RULE_THREE_LAYER, MOC_Y_AXIS_DOWN);
    float quad[16];
    int32_t result = -1;
    CHECK_EQ(MOC_SetResolution(moc, W, H), MOC_STATUS_OK);
    CHECK_EQ(MOC_SetNearClipPlane(moc, 2.0f), MOC_STATUS_OK);
    quad_at(quad, -2.0f, -2.0f, 2.0f, 2.0f, 1.0f);
    CHECK_EQ(render(moc, quad), MOC_VIEW_CULLED);
    CHECK_EQ(test_rect(moc, -0.5f, -0.5f, 0.5f, 0.5f, 30.0f), MOC_VISIBLE);
    CHECK_EQ(MOC_RenderTriangles(moc, quad, QUAD, 2, NULL, MOC_BACKFACE_CW, MOC_CLIP_PLANE_SIDES, NULL, &result),
             MOC_STATUS_OK);
    CHECK_EQ(result, MOC_VISIBLE);
    CHECK_EQ(test_rect(moc, -0.5f, -0.5f, 0.5f, 0.5f, 30.0f), MOC_OCCLUDED);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

static void transform(void)
{
    enum { N = 37 };
    const float matrix[16] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
    const MOC_VertexLayout arrays = {4, 4 * N, 8 * N};
    float in[3 * N], soa[3 * N], out[4 * N + 1], again[4 * N];
    int i, c;
    for (i = 0; i < N; i++)
        for (c = 0; c < 3; c++)
            soa[N * c + i] = in[3 * i + c] = (float)(i * (c + 1) - 20);
    out[4 * N] = 77.0f;
    CHECK_EQ(MOC_TransformVertices(matrix, in, out, N, NULL), MOC_STATUS_OK);
    CHECK(out[4 * N] == 77.0f);
    for (i = 0; i < N; i++)
        for (c = 0; c < 4; c++)
            CHECK(out[4 * i + c] == in[3 * i] * matrix[c] + in[3 * i + 1] * matrix[4 + c] +
                                        in[3 * i + 2] * matrix[8 + c] + matrix[12 + c]);
    CHECK_EQ(MOC_TransformVertices(matrix, soa, again, N, &arrays), MOC_STATUS_OK);
    CHECK(memcmp(out, again, sizeof again) == 0);
    CHECK_EQ(MOC_TransformVertices(matrix, NULL, NULL, 0, NULL), MOC_STATUS_OK);
}

static void callbacks(void)
{
    MaskedOcclusionCulling *moc = make(MOC_AVX512, MOC_UPDATE_RULE_THREE_LAYER, MOC_Y_AXIS_DOWN);
    MOC_AlignedAlloc alloc = NULL;
    MOC_AlignedFree release = NULL;
    void *memory;
    CHECK_EQ(MOC_GetAllocFreeCallback(moc, &alloc, &release), MOC_STATUS_OK);
    CHECK(alloc != NULL && release != NULL);
    memory = alloc(64, 1000);
    CHECK(memory != NULL && (uintptr_t)memory % 64 == 0);
    memset(memory, 1, 1000);
    release(memory);
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

int main(void)
{
    const int32_t implementations[] = {MOC_SCALAR, MOC_SSE2, MOC_SSE41, MOC_AVX2, MOC_AVX512, MOC_NEON, MOC_SIMD128};
    int32_t rule;
    size_t i;
    versions();
    transform();
    callbacks();
    sizes();
    for (rule = MOC_UPDATE_RULE_THREE_LAYER; rule <= MOC_UPDATE_RULE_FOUR_LAYER; rule++) {
        properties(rule);
        for (i = 0; i < sizeof implementations / sizeof *implementations; i++) {
            wall(implementations[i], rule, MOC_Y_AXIS_DOWN);
            wall(implementations[i], rule, MOC_Y_AXIS_UP);
            bins(implementations[i], rule, MOC_Y_AXIS_DOWN);
            bins(implementations[i], rule, MOC_Y_AXIS_UP);
            merge(implementations[i], rule);
        }
    }
    for (i = 0; i < sizeof implementations / sizeof *implementations; i++) {
        layouts(implementations[i]);
        checked(implementations[i]);
        meshes(implementations[i]);
        near_plane(implementations[i]);
    }
    return check_report("all_functions");
}
