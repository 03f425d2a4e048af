/* Arrays of exactly the required length, in guarded memory: nothing outside them is read or written. */
#define _DEFAULT_SOURCE 1
#include "deadline.h"
#include "guarded_object.h"

/* Arrays of the required length, exact to the byte: nothing outside them is read or written. */
static void exact_arrays(int32_t implementation)
{
    static const MOC_VertexLayout clip = {16, 4, 12}, padded = {16, 4, 8}, packed = {12, 4, 8}, wide = {36, 8, 20};
    const MOC_VertexLayout *layouts[] = {&clip, &padded, &packed, &wide};
    const float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 3};
    MaskedOcclusionCulling *moc = make(implementation, MOC_UPDATE_RULE_THREE_LAYER);
    const uint32_t sizes[][2] = {{1, 1}, {8, 4}, {31, 7}, {33, 9}, {127, 65}, {640, 1}, {1, 640}, {16384, 3}, {3, 16384}};
    uint32_t seed = 5;
    int n, k;
    size_t i;
    for (n = 1; n < 70; n++) {
        for (k = 0; k < 4; k++) {
            const MOC_VertexLayout *layout = layouts[k];
            const int vertices = n + 2;
            const int last = layout->offset_zw > layout->offset_y ? layout->offset_zw : layout->offset_y;
            const size_t bytes = (size_t)layout->stride * (size_t)(vertices - 1) + (size_t)last + 4;
            /* Every other time the end is not a multiple of 4. */
            const size_t slack = n % 2 == 0 ? 0 : 1;
            unsigned char *block = (unsigned char *)guarded_alloc(1, bytes + slack);
            float *data = (float *)(void *)block, *out = (float *)guarded_alloc(4, 16 * (size_t)vertices);
            uint32_t *indices = (uint32_t *)guarded_alloc(4, 12 * (size_t)n);
            float *storage = (float *)guarded_alloc(4, 36 * (size_t)n);
            MOC_TriList list;
            int32_t status, result;
            int v;
            for (v = 0; v < vertices; v++) {
                const float x = 4.0f * next_unit(&seed), y = 4.0f * next_unit(&seed), w = 3.0f + next_unit(&seed);
                memcpy(block + v * layout->stride, &x, 4);
                memcpy(block + v * layout->stride + layout->offset_y, &y, 4);
                memcpy(block + v * layout->stride + layout->offset_zw, &w, 4);
            }
            for (v = 0; v < 3 * n; v++)
                indices[v] = (uint32_t)(v / 3 + v % 3);
            for (v = 0; v < 2; v++) {
                const float *m = v == 0 ? NULL : matrix;
                CHECK_EQ(MOC_RenderTriangles(moc, data, indices, n, m, 0, MOC_CLIP_PLANE_ALL, layout, &result), 0);
                CHECK_EQ(MOC_TestTriangles(moc, data, indices, n, m, 0, MOC_CLIP_PLANE_ALL, layout, &result), 0);
                list.capacity = (uint32_t)n;
                list.count = 0;
                list.data = storage;
                status = MOC_BinTriangles(moc, data, indices, n, &list, 1, 1, m, 0, MOC_CLIP_PLANE_ALL, layout, NULL);
                CHECK(status == MOC_STATUS_OK || status == MOC_STATUS_LIST_FULL);
                CHECK_EQ(MOC_RenderTrilist(moc, &list, NULL), MOC_STATUS_OK);
                CHECK_EQ(MOC_RenderTrianglesChecked(moc, data, (bytes + 3) / 4, indices, n, m, 0, MOC_CLIP_PLANE_ALL,
                                                    layout, &result), 0);
                indices[3 * n - 1]++;
                CHECK_EQ(MOC_RenderTrianglesChecked(moc, data, bytes / 4, indices, n, m, 0, MOC_CLIP_PLANE_ALL,
                                                    layout, &result), MOC_STATUS_INDEX_OUT_OF_RANGE);
                indices[3 * n - 1] = UINT32_MAX;
                CHECK_EQ(MOC_TestTrianglesChecked(moc, data, bytes / 4, indices, n, m, 0, MOC_CLIP_PLANE_ALL,
                                                  layout, &result), MOC_STATUS_INDEX_OUT_OF_RANGE);
                indices[3 * n - 1] = (uint32_t)(n + 1);
            }
            CHECK_EQ(MOC_TransformVertices(matrix, data, out, (uint32_t)vertices, layout), MOC_STATUS_OK);
            guarded_release(block, bytes + slack);
            guarded_release(out, 16 * (size_t)vertices);
            guarded_release(indices, 12 * (size_t)n);
            guarded_release(storage, 36 * (size_t)n);
        }
    }
    still_works(moc);

    for (i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const size_t pixels = (size_t)sizes[i][0] * sizes[i][1];
        float *depth = (float *)guarded_alloc(4, 4 * pixels), quad[16];
        size_t p, holes = 0;
        int32_t result = -1;
        quad_at(quad, -3.0f, -3.0f, 3.0f, 3.0f, 4.0f);
        CHECK_EQ(MOC_SetResolution(moc, sizes[i][0], sizes[i][1]), MOC_STATUS_OK);
        CHECK_EQ(MOC_RenderTriangles(moc, quad, QUAD, 2, NULL, 0, MOC_CLIP_PLANE_ALL, NULL, NULL), MOC_STATUS_OK);
        CHECK_EQ(MOC_ComputePixelDepthBuffer(moc, depth, (int32_t)(i % 2)), MOC_STATUS_OK);
        for (p = 0; p < pixels; p++)
            holes += !(depth[p] > 0.2499f && depth[p] <= 0.25f);
        CHECK_EQ(holes, 0);
        CHECK_EQ(MOC_TestRect(moc, -1.0f, -1.0f, 1.0f, 1.0f, 5.0f, &result), MOC_STATUS_OK);
        CHECK_EQ(result, MOC_OCCLUDED);
        guarded_release(depth, 4 * pixels);
    }
    CHECK_EQ(MOC_Destroy(moc), MOC_STATUS_OK);
}

int main(void)
{
    int i;
    deadline(500);
    for (i = 0; i < N_IMPLEMENTATIONS; i++)
        exact_arrays(IMPLEMENTATIONS[i]);
    CHECK_EQ(guarded_live_blocks(), 0);
    return check_report("exact_arrays");
}
