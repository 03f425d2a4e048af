// A program as engines write it: every method of the class, every default argument, its own allocators.
#define ENABLE_STATS 1
#include "check.h"

#include "MaskedOcclusionCulling.h"

#include <memory>
#include <vector>

class MaskedOcclusionCulling; // as engines declare it

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
    CHECK(alignment != 0 && (alignment & (alignment - 1)) == 0);
    CHECK(size % alignment == 0);
    allocations++;
    // The pointer from malloc is stored right in front of the block.
    char *base = static_cast<char *>(malloc(size + 2 * alignment + sizeof(void *)));
    char *block = base + sizeof(void *);
    block += alignment - reinterpret_cast<uintptr_t>(block) % alignment;
    if (misaligned)
        block += sizeof(void *);
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

void EveryMethod()
{
    MOC *moc = MOC::Create();
    CHECK(moc != nullptr);
    unsigned int width = 1, height = 1;
    moc->GetResolution(width, height);
    CHECK(width == 0 && height == 0);
    CHECK(moc->TestRect(-1, -1, 1, 1, 1) == MOC::VISIBLE); // no buffer yet

    moc->SetResolution(320, 180);
    moc->SetNearClipPlane(0.5f);
    CHECK(moc->GetNearClipPlane() == 0.5f);
    moc->SetNearClipPlane(0.0f);
    moc->ClearBuffer();
    moc->GetResolution(width, height);
    CHECK(width == 320 && height == 180);
    unsigned int bin_width = 0, bin_height = 0;
    moc->ComputeBinWidthHeight(4, 4, bin_width, bin_height);
    CHECK(bin_width == 64 && bin_height == 40);
    moc->ComputeBinWidthHeight(0, 4, bin_width, bin_height);
    CHECK(bin_width == 0 && bin_height == 0);

    // An occluder in clip space with all default arguments, then a hidden one and a nearer one.
    struct ClipspaceVertex
    {
        float x, y, z, w;
    };
    ClipspaceVertex wall[] = {{-5, -5, 0, 10}, {5, -5, 0, 10}, {5, 5, 0, 10}, {-5, 5, 0, 10}};
    unsigned int indices[] = {0, 1, 2, 0, 2, 3};
    CHECK(moc->RenderTriangles(reinterpret_cast<float *>(wall), indices, 2) == MOC::VISIBLE);
    ClipspaceVertex hidden[] = {{-5, -5, 0, 20}, {5, -5, 0, 20}, {0, 5, 0, 20}};
    CHECK(moc->TestTriangles(reinterpret_cast<float *>(hidden), indices, 1) == MOC::OCCLUDED);
    ClipspaceVertex nearer[] = {{-1, -1, 0, 8}, {1, -1, 0, 8}, {0, 1, 0, 8}};
    CHECK(moc->TestTriangles(reinterpret_cast<float *>(nearer), indices, 1) == MOC::VISIBLE);
    CHECK(moc->TestRect(-0.4f, -0.4f, 0.4f, 0.4f, 20) == MOC::OCCLUDED);
    CHECK(moc->TestRect(-0.6f, -0.4f, 0.4f, 0.4f, 20) == MOC::VISIBLE);
    CHECK(moc->TestRect(-3.0f, -0.4f, -2.0f, 0.4f, 20) == MOC::VIEW_CULLED);

    // Each default argument passed explicitly, one after the other.
    const float *v = reinterpret_cast<float *>(wall);
    CHECK(moc->RenderTriangles(v, indices, 2, nullptr) == MOC::VISIBLE);
    CHECK(moc->RenderTriangles(v, indices, 2, nullptr, MOC::BACKFACE_CCW) == MOC::VIEW_CULLED);
    CHECK(moc->RenderTriangles(v, indices, 2, nullptr, MOC::BACKFACE_NONE, MOC::CLIP_PLANE_NONE) == MOC::VISIBLE);
    CHECK(moc->RenderTriangles(v, indices, 2, nullptr, MOC::BACKFACE_CW, MOC::CLIP_PLANE_SIDES,
                               MOC::VertexLayout(16, 4, 12)) == MOC::VISIBLE);
    CHECK(moc->TestTriangles(v, indices, 2, nullptr, MOC::BACKFACE_CW,
                             static_cast<MOC::ClipPlanes>(MOC::CLIP_PLANE_NEAR | MOC::CLIP_PLANE_LEFT),
                             MOC::VertexLayout(16, 4, 12)) == MOC::VISIBLE);

    // Model space: positions, a matrix (x' = x, y' = y, w' = z + 10), and a layout that gives the offset of z.
    const float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 10};
    const float positions[] = {-2, -2, 10, 2, -2, 10, 0, 2, 10};
    MOC::VertexLayout layout;
    layout.mStride = 12;
    layout.mOffsetY = 4;
    layout.mOffsetZ = 8;
    CHECK(layout.mOffsetW == 8);
    CHECK(moc->TestTriangles(positions, indices, 1, matrix, MOC::BACKFACE_CW, MOC::CLIP_PLANE_ALL, layout) ==
          MOC::OCCLUDED);
    float transformed[12];
    MOC::TransformVertices(matrix, positions, transformed, 3);
    CHECK(transformed[0] == -2 && transformed[2] == 10 && transformed[3] == 20);
    MOC::TransformVertices(matrix, positions, transformed, 3, layout);
    CHECK(moc->TestTriangles(transformed, indices, 1) == MOC::OCCLUDED);

    // The depth buffer in both row directions.
    std::vector<float> depth(320 * 180), flipped(320 * 180);
    moc->ComputePixelDepthBuffer(depth.data(), false);
    moc->ComputePixelDepthBuffer(flipped.data(), true);
    CHECK(depth[0] < 0.0f);
    const float centre = depth[90 * 320 + 160];
    CHECK(centre > 0.0999f && centre <= 0.1f);
    CHECK(memcmp(&depth[0], &flipped[179 * 320], 320 * sizeof(float)) == 0);

    const MOC::OcclusionCullingStatistics stats = moc->GetStatistics();
    CHECK(stats.mOccluders.mNumProcessedTriangles == 10);
    CHECK(stats.mOccluders.mNumRasterizedTriangles >= 2);
    CHECK(stats.mOccluders.mNumTilesTraversed >= stats.mOccluders.mNumTilesUpdated);
    CHECK(stats.mOccluders.mNumTilesUpdated >= stats.mOccluders.mNumTilesMerged);
    CHECK(stats.mOccluders.mNumTilesMerged > 0);
    CHECK(moc->GetNumDroppedTriangles() == 0);
    CHECK(stats.mOccludees.mNumProcessedRectangles == 3);
    CHECK(stats.mOccludees.mNumProcessedTriangles == 6);
    CHECK(stats.mOccludees.mNumRasterizedTriangles > 0);
    CHECK(stats.mOccludees.mNumTilesTraversed > 0);

    // Merging.
    MOC *other = MOC::Create(MOC::SSE2);
    other->SetResolution(320, 180);
    CHECK(other->TestRect(-0.4f, -0.4f, 0.4f, 0.4f, 20) == MOC::VISIBLE);
    other->MergeBuffer(moc);
    CHECK(other->TestRect(-0.4f, -0.4f, 0.4f, 0.4f, 20) == MOC::OCCLUDED);
    CHECK(other->TestRect(-0.6f, -0.4f, 0.4f, 0.4f, 20) == MOC::VISIBLE);
    moc->MergeBuffer(moc);
    moc->MergeBuffer(nullptr);
    MOC::Destroy(other);
    MOC::Destroy(nullptr);

    // A rejected size changes nothing.
    moc->SetResolution(0, 180);
    moc->SetResolution(16385, 180);
    moc->GetResolution(width, height);
    CHECK(width == 320 && height == 180);
    CHECK(moc->TestRect(-0.4f, -0.4f, 0.4f, 0.4f, 20) == MOC::OCCLUDED);
    MOC::Destroy(moc);
}

void Bins()
{
    enum { N = 200, BINS = 4 };
    std::unique_ptr<MOC, void (*)(MOC *)> moc(MOC::Create(MOC::AVX2), &MOC::Destroy);
    moc->SetResolution(320, 180);
    std::vector<float> vertices(12 * N), direct(320 * 180), binned(320 * 180), storage(BINS * 9 * 2 * N);
    std::vector<unsigned int> indices(3 * N);
    random_triangles(vertices.data(), indices.data(), N, 99);
    moc->RenderTriangles(vertices.data(), indices.data(), N);
    moc->ComputePixelDepthBuffer(direct.data(), false);

    moc->ClearBuffer();
    MOC::TriList lists[BINS];
    for (int i = 0; i < BINS; i++) {
        lists[i].mNumTriangles = 2 * N;
        lists[i].mTriIdx = 0;
        lists[i].mPtr = &storage[i * 9 * 2 * N];
    }
    unsigned int width, height;
    moc->ComputeBinWidthHeight(2, 2, width, height);
    moc->BinTriangles(vertices.data(), indices.data(), N, lists, 2, 2);
    for (int i = 0; i < BINS; i++) {
        const int x = i % 2 * static_cast<int>(width), y = i / 2 * static_cast<int>(height);
        const MOC::ScissorRect rect(x, y, i % 2 == 1 ? 320 : x + static_cast<int>(width),
                                    i / 2 == 1 ? 180 : y + static_cast<int>(height));
        CHECK(lists[i].mTriIdx > 0);
        moc->RenderTrilist(lists[i], &rect);
    }
    moc->ComputePixelDepthBuffer(binned.data(), false);
    CHECK(direct == binned);

    // All arguments passed, one list, drawn everywhere; a full list; a rejected rectangle.
    moc->ClearBuffer();
    lists[0].mTriIdx = 0;
    moc->BinTriangles(vertices.data(), indices.data(), N, lists, 1, 1, nullptr, MOC::BACKFACE_CW, MOC::CLIP_PLANE_ALL,
                      MOC::VertexLayout(16, 4, 12));
    MOC::ScissorRect wrong;
    wrong = MOC::ScissorRect(1, 0, 33, 8);
    moc->RenderTrilist(lists[0], &wrong);
    moc->ComputePixelDepthBuffer(binned.data(), false);
    CHECK(binned == std::vector<float>(binned.size(), binned[0]) && binned[0] < 0.0f);
    moc->RenderTrilist(lists[0], nullptr);
    moc->ComputePixelDepthBuffer(binned.data(), false);
    CHECK(direct == binned);
    lists[0].mTriIdx = 0;
    lists[0].mNumTriangles = 5;
    moc->BinTriangles(vertices.data(), indices.data(), N, lists, 1, 1);
    CHECK(lists[0].mTriIdx == 5);
}

void Allocators()
{
    {
        MOC *moc = MOC::Create(MOC::AVX512, CountingAlloc, CountingFree);
        CHECK(moc != nullptr && allocations == 1); // the object itself
        MOC::pfnAlignedAlloc alloc_callback = nullptr;
        MOC::pfnAlignedFree free_callback = nullptr;
        moc->GetAllocFreeCallback(alloc_callback, free_callback);
        CHECK(alloc_callback == CountingAlloc && free_callback == CountingFree);
        moc->SetResolution(640, 480);
        CHECK(allocations > 1);
        moc->SetResolution(641, 3);
        CHECK(frees > 0);
        float quad[16];
        quad_at(quad, -2, -2, 2, 2, 10);
        CHECK(moc->RenderTriangles(quad, QUAD, 2) == MOC::VISIBLE);

        // Out of memory: the buffer stays.
        fail_after = 0;
        moc->SetResolution(1920, 1080);
        fail_after = -1;
        unsigned int width, height;
        moc->GetResolution(width, height);
        CHECK(width == 641 && height == 3);
        CHECK(moc->TestRect(-0.5f, -0.5f, 0.5f, 0.5f, 20) == MOC::OCCLUDED);

        // Misaligned memory is returned and not used.
        misaligned = true;
        moc->SetResolution(1920, 1080);
        misaligned = false;
        moc->GetResolution(width, height);
        CHECK(width == 641 && height == 3);
        MOC::Destroy(moc);
        CHECK_EQ(frees, allocations);
    }

    // Makes every allocation in an object's life fail once.
    for (int n = 0; n < 8; n++) {
        fail_after = n;
        MOC *moc = MOC::Create(MOC::AVX512, CountingAlloc, CountingFree);
        CHECK((moc == nullptr) == (n == 0));
        if (moc != nullptr) {
            moc->SetResolution(64, 64);
            moc->SetResolution(128, 64);
            MOC::Destroy(moc);
        }
        fail_after = -1;
        CHECK_EQ(frees, allocations);
    }

    // A single callback is rejected; with none, the library's own are used, which can be called.
    CHECK(MOC::Create(MOC::AVX512, CountingAlloc, nullptr) == nullptr);
    CHECK(MOC::Create(MOC::AVX512, nullptr, CountingFree) == nullptr);
    MOC *moc = MOC::Create(MOC::AVX512, nullptr, nullptr);
    CHECK(moc != nullptr);
    MOC::pfnAlignedAlloc alloc_callback = nullptr;
    MOC::pfnAlignedFree free_callback = nullptr;
    moc->GetAllocFreeCallback(alloc_callback, free_callback);
    CHECK(alloc_callback != nullptr && free_callback != nullptr);
    MOC *second = MOC::Create(MOC::AVX512, alloc_callback, free_callback);
    CHECK(second != nullptr);
    second->SetResolution(64, 64);
    MOC::Destroy(second);
    void *memory = alloc_callback(256, 1000);
    CHECK(memory != nullptr && reinterpret_cast<uintptr_t>(memory) % 256 == 0);
    memset(memory, 0xff, 1000);
    free_callback(memory);
    MOC::Destroy(moc);
    CHECK_EQ(frees, allocations);
}

void Implementations()
{
    const MOC::Implementation asked[] = {MOC::SCALAR, MOC::SSE2, MOC::SSE41, MOC::AVX2, MOC::AVX512,
                                         MOC::NEON,   MOC::SIMD128};
    for (MOC::Implementation implementation : asked) {
        MOC *moc = MOC::Create(implementation);
        const MOC::Implementation got = moc->GetImplementation();
        const bool x86_asked = implementation >= MOC::SSE2 && implementation <= MOC::AVX512;
        if (implementation == MOC::SCALAR)
            CHECK_EQ(got, SIMPLEST_IMPLEMENTATION);
        else if (x86_asked && got != MOC::NEON)
            CHECK(got <= implementation);
        MOC::Destroy(moc);
    }
    CHECK(MOC::Create(static_cast<MOC::Implementation>(77)) == nullptr);
    // A pointer to the function can be taken, as with Intel's class.
    MOC *(*create)(MOC::Implementation) = &MOC::Create;
    MOC::Destroy(create(MOC::SSE41));
}

} // namespace

int main()
{
    EveryMethod();
    Bins();
    Allocators();
    Implementations();
    return check_report("peer_style");
}
