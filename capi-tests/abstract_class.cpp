// A program for a class with virtual methods (abstract_header), linked with link/ and the library: every method, the
// switches from the command line, memory, and the pool.
#include "check.h"

#include "CullingThreadpool.h"
#include "../link/LinkedObject.h"

#include <vector>

namespace
{

typedef MaskedOcclusionCulling MOC;

int allocations = 0, frees = 0, fail_after = -1;
bool misaligned = false;

void *CountingAlloc(size_t alignment, size_t size)
{
    if (fail_after == 0)
        return nullptr;
    if (fail_after > 0)
        fail_after--;
    CHECK(alignment >= 64 && (alignment & (alignment - 1)) == 0 && size % alignment == 0);
    allocations++;
    char *base = static_cast<char *>(malloc(size + 2 * alignment + sizeof(void *)));
    char *block = base + sizeof(void *);
    block += alignment - reinterpret_cast<uintptr_t>(block) % alignment;
    // The second allocation is the object with the methods.
    if (misaligned && allocations % 2 == 0)
        block += 1;
    memcpy(block - sizeof(void *), &base, sizeof(void *));
    return block;
}

void CountingFree(void *ptr)
{
    frees++;
    void *base;
    memcpy(&base, static_cast<char *>(ptr) - sizeof(void *), sizeof(void *));
    free(base);
}

std::vector<float> Depth(MOC *moc)
{
    unsigned int width, height;
    moc->GetResolution(width, height);
    std::vector<float> depth(width * height);
    moc->ComputePixelDepthBuffer(depth.data(), false);
    return depth;
}

void EveryMethod(MOC *moc)
{
    unsigned int width = 1, height = 1;
    moc->GetResolution(width, height);
    CHECK(width == 0 && height == 0);
    moc->SetResolution(320, 180);
    moc->GetResolution(width, height);
    CHECK(width == 320 && height == 180);
    moc->ComputeBinWidthHeight(3, 2, width, height);
    CHECK(width == 96 && height == 88);
    moc->SetNearClipPlane(0.5f);
    CHECK(moc->GetNearClipPlane() == 0.5f);
    moc->ClearBuffer();

    float wall[16];
    quad_at(wall, -0.5f, -0.5f, 0.5f, 0.25f, 10);
    CHECK(moc->RenderTriangles(wall, QUAD, 2) == MOC::VISIBLE);
    CHECK(moc->RenderTriangles(wall, QUAD, 2, nullptr, MOC::BACKFACE_CCW) == MOC::VIEW_CULLED);
    CHECK(moc->TestRect(-0.4f, -0.4f, 0.4f, 0.2f, 20) == MOC::OCCLUDED);
    CHECK(moc->TestRect(-0.4f, -0.4f, 0.4f, 0.4f, 20) == MOC::VISIBLE);
    CHECK(moc->TestRect(-3, -0.4f, -2, 0.4f, 20) == MOC::VIEW_CULLED);
    const float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 10};
    const float positions[] = {-2, -2, 10, 2, -2, 10, 0, 2, 10};
    const MOC::VertexLayout layout(12, 4, 8);
    CHECK(moc->TestTriangles(positions, QUAD, 1, matrix, MOC::BACKFACE_CW, MOC::CLIP_PLANE_ALL, layout) ==
          MOC::OCCLUDED);
    float transformed[12];
    MOC::TransformVertices(matrix, positions, transformed, 3);
    CHECK(transformed[0] == -2 && transformed[2] == 10 && transformed[3] == 20);
    CHECK(moc->TestTriangles(transformed, QUAD, 1) == MOC::OCCLUDED);

    // The wall extends farther down than up.
    const std::vector<float> depth = Depth(moc);
    CHECK(depth[0] < 0.0f && depth[90 * 320 + 160] > 0.0999f && depth[90 * 320 + 160] <= 0.1f);
    CHECK((depth[50 * 320 + 160] < 0.0f) == (USE_D3D != 0));
    CHECK((depth[130 * 320 + 160] < 0.0f) == (USE_D3D == 0));
    std::vector<float> flipped(depth.size());
    moc->ComputePixelDepthBuffer(flipped.data(), true);
    CHECK(memcmp(&depth[50 * 320], &flipped[129 * 320], 320 * sizeof(float)) == 0);

    const MOC::OcclusionCullingStatistics stats = moc->GetStatistics();
    CHECK_EQ(stats.mOccluders.mNumProcessedTriangles, ENABLE_STATS ? 4 : 0);
    CHECK_EQ(stats.mOccludees.mNumProcessedRectangles, ENABLE_STATS ? 3 : 0);
    CHECK_EQ(stats.mOccludees.mNumProcessedTriangles, ENABLE_STATS ? 2 : 0);
    CHECK_EQ(stats.mOccluders.mNumTilesMerged > 0, ENABLE_STATS != 0);
    CHECK_EQ(stats.mOccludees.mNumTilesTraversed > 0, ENABLE_STATS != 0);

    MOC *other = MOC::Create(MOC::SSE2);
    other->SetResolution(320, 180);
    other->MergeBuffer(moc);
    other->MergeBuffer(nullptr);
    CHECK(other->TestRect(-0.4f, -0.4f, 0.4f, 0.2f, 20) == MOC::OCCLUDED);
    MOC::Destroy(other);
    MOC::Destroy(nullptr);
}

void Bins(MOC *moc)
{
    enum { N = 200 };
    std::vector<float> vertices(12 * N), storage(4 * 9 * 2 * N);
    std::vector<unsigned int> indices(3 * N);
    random_triangles(vertices.data(), indices.data(), N, 99);
    moc->SetResolution(320, 180);
    moc->RenderTriangles(vertices.data(), indices.data(), N);
    const std::vector<float> direct = Depth(moc);

    MOC::TriList lists[4];
    for (int i = 0; i < 4; i++)
        lists[i] = {2 * N, 0, &storage[i * 9 * 2 * N]};
    moc->ClearBuffer();
    moc->BinTriangles(vertices.data(), indices.data(), N, lists, 2, 2);
    const MOC::ScissorRect rects[4] = {MOC::ScissorRect(0, 0, 160, 88), MOC::ScissorRect(160, 0, 320, 88),
                                       MOC::ScissorRect(0, 88, 160, 180), MOC::ScissorRect(160, 88, 320, 180)};
    for (int i = 0; i < 4; i++)
        moc->RenderTrilist(lists[i], &rects[i]);
    CHECK(Depth(moc) == direct);
    moc->ClearBuffer();
    lists[0].mTriIdx = 0;
    moc->BinTriangles(vertices.data(), indices.data(), N, lists, 1, 1);
    moc->RenderTrilist(lists[0], nullptr);
    CHECK(Depth(moc) == direct);

    // The pool draws the same.
    CullingThreadpool pool(2, 2, 2);
    pool.SetBuffer(moc);
    pool.WakeThreads();
    pool.SetResolution(320, 180);
    pool.SetNearClipPlane(0.5f);
    pool.ClearBuffer();
    pool.SetMatrix();
    pool.SetVertexLayout();
    pool.RenderTriangles(vertices.data(), indices.data(), N);
    pool.TestRect(-1, -1, 1, 1, 20);
    pool.Flush();
    CHECK(Depth(moc) == direct);
    std::vector<float> depth(direct.size());
    pool.ComputePixelDepthBuffer(depth.data(), false);
    CHECK(depth == direct);
    CHECK(pool.TestTriangles(vertices.data(), indices.data(), N) == MOC::VISIBLE);
    pool.SuspendThreads();
}

// The object has the settings that the command line requests.
void Switches(bool chosen)
{
    MOC *moc = MOC::Create();
    int32_t rule = -1, implementation = -1;
    CHECK_EQ(MOC_GetUpdateRule(moc_link::ObjectOf(moc), &rule), MOC_STATUS_OK);
    CHECK_EQ(MOC_GetImplementation(moc_link::ObjectOf(moc), &implementation), MOC_STATUS_OK);
    const int32_t unless_accurate = chosen ? MOC_UPDATE_RULE_QUICK : MOC_UPDATE_RULE_THREE_LAYER;
#ifdef MOC_FOUR_LAYERS
    const bool four_layers = MOC_FOUR_LAYERS;
#else
    const bool four_layers = false;
#endif
    const int32_t unless_four = QUICK_MASK == 0 ? MOC_UPDATE_RULE_ACCURATE : unless_accurate;
    CHECK_EQ(rule, four_layers ? MOC_UPDATE_RULE_FOUR_LAYER : unless_four);
    const bool named = implementation >= MOC_SSE2 && implementation <= MOC_AVX512;
    CHECK_EQ(moc->GetImplementation(), named ? implementation : MOC_SSE2);
    if (chosen && USE_AVX512 == 0)
        CHECK(moc->GetImplementation() <= MOC::AVX2);
    MOC::Destroy(moc);
    moc = MOC::Create(MOC::SSE41);
    CHECK(moc->GetImplementation() <= MOC::SSE41);
    MOC::Destroy(moc);
}

void Memory()
{
    for (int n = 0; n < 8; n++) {
        fail_after = n;
        MOC *moc = MOC::Create(MOC::AVX512, CountingAlloc, CountingFree);
        CHECK((moc == nullptr) == (n < 2)); // the library's object, and the one with the methods
        if (moc != nullptr) {
            moc->SetResolution(64, 64);
            MOC::Destroy(moc);
        }
        fail_after = -1;
        CHECK_EQ(frees, allocations);
    }
    allocations = frees = 0;
    misaligned = true;
    CHECK(MOC::Create(MOC::AVX512, CountingAlloc, CountingFree) == nullptr);
    misaligned = false;
    CHECK(allocations == 2 && frees == 2);
    CHECK(MOC::Create(MOC::AVX512, CountingAlloc, nullptr) == nullptr);

    MOC *moc = MOC::Create(MOC::AVX2, CountingAlloc, CountingFree);
    MOC::pfnAlignedAlloc alloc_callback = nullptr;
    MOC::pfnAlignedFree free_callback = nullptr;
    moc->GetAllocFreeCallback(alloc_callback, free_callback);
    CHECK(alloc_callback == CountingAlloc && free_callback == CountingFree);
    MOC::Destroy(moc);
    CHECK_EQ(frees, allocations);
    moc = MOC::Create();
    moc->GetAllocFreeCallback(alloc_callback, free_callback);
    CHECK(alloc_callback != nullptr && free_callback != nullptr);
    MOC::Destroy(moc);
}

} // namespace

int main(int argc, char **)
{
    MOC *moc = MOC::Create(MOC::AVX512, CountingAlloc, CountingFree);
    CHECK_EQ(allocations, 2);
    EveryMethod(moc);
    Bins(moc);
    MOC::Destroy(moc);
    CHECK_EQ(frees, allocations);
    Switches(argc > 1);
    Memory();
    return check_report("abstract_class");
}
