// What programs written for Intel's library rely on implicitly: the headers that its headers include, enumerations that
// a switch can exhaust, a processor that flushes denormals, and a pool created with no threads.
#include "CullingThreadpool.h"

#include "check.h"

#include <vector>

#if defined(__SSE2__) || defined(_M_X64)
#include <emmintrin.h>
#define HAS_MXCSR 1
#else
#define HAS_MXCSR 0
#endif

namespace
{

typedef MaskedOcclusionCulling MOC;

const int WIDTH = 1920, HEIGHT = 1080;

struct ClipspaceVertex
{
    float x, y, z, w;
};

// With warnings as errors, this only compiles if the enumerations have exactly these values.
const char *Name(MOC::Implementation implementation)
{
    switch (implementation) {
    case MOC::SSE2: return "SSE2";
    case MOC::SSE41: return "SSE4.1";
    case MOC::AVX2: return "AVX2";
    case MOC::AVX512: return "AVX-512";
    }
    return "something newer";
}

const char *Name(MOC::CullingResult result)
{
    switch (result) {
    case MOC::VISIBLE: return "visible";
    case MOC::OCCLUDED: return "occluded";
    case MOC::VIEW_CULLED: return "out of view";
    }
    return "?";
}

const char *Name(MOC::BackfaceWinding winding)
{
    switch (winding) {
    case MOC::BACKFACE_NONE: return "none";
    case MOC::BACKFACE_CW: return "clockwise";
    case MOC::BACKFACE_CCW: return "counter-clockwise";
    }
    return "?";
}

void Enumerations(MOC *moc)
{
    // The added ones have the enumeration's type and can be bound to references, even before C++17.
    const MOC::Implementation &scalar = MOC::SCALAR, &neon = MOC::NEON, &simd128 = MOC::SIMD128;
    CHECK_EQ(scalar, MOC_SCALAR);
    CHECK_EQ(neon, MOC_NEON);
    CHECK_EQ(simd128, MOC_SIMD128);
    const MOC::Implementation is = moc->GetImplementation();
    CHECK(is == MOC::SCALAR || is == MOC::NEON || is == MOC::SIMD128 || strcmp(Name(is), "something newer") != 0);
    CHECK(strcmp(Name(MOC::VIEW_CULLED), "out of view") == 0 && strcmp(Name(MOC::BACKFACE_CW), "clockwise") == 0);
}

// A triangle across the near plane and the sides, one with the other winding, a quad that is declared to be inside all
// planes, and a triangle whose coordinates are in separate arrays.
void Draw(MOC *moc)
{
    const unsigned int tri[] = {0, 1, 2}, quad[] = {0, 1, 2, 0, 2, 3};
    const ClipspaceVertex across[] = {{5, 0, 0, 10}, {30, 0, 0, 20}, {10, 50, 0, 0.5f}};
    moc->RenderTriangles((const float *)across, tri, 1);
    const ClipspaceVertex clockwise[] = {{14, -14, 0, 20}, {16, -14, 0, 20}, {14, -16, 0, 20}};
    CHECK(moc->RenderTriangles((const float *)clockwise, tri, 1) == MOC::VIEW_CULLED);
    CHECK(moc->RenderTriangles((const float *)clockwise, tri, 1, nullptr, MOC::BACKFACE_CCW) == MOC::VISIBLE);
    const ClipspaceVertex inside[] = {{-90, -90, 0, 100}, {-5, -45, 0, 50}, {0, 0, 0, 20}, {-30, 5, 0, 40}};
    moc->RenderTriangles((const float *)inside, quad, 2, nullptr, MOC::BACKFACE_CW, MOC::CLIP_PLANE_NONE);
    const float apart[] = {10, 10, 7, -10, -7, -10, 10, 10, 10};
    const MOC::VertexLayout layout(sizeof(float), 3 * sizeof(float), 6 * sizeof(float));
    moc->RenderTriangles(apart, tri, 1, nullptr, MOC::BACKFACE_CW, MOC::CLIP_PLANE_ALL, layout);
}

float At(const std::vector<float> &depth, float x, float y)
{
    const int column = static_cast<int>((x + 1) / 2 * WIDTH), row = static_cast<int>((1 - y) / 2 * HEIGHT);
    return depth[row * WIDTH + column];
}

std::vector<float> Example(MOC *moc)
{
    moc->SetResolution(WIDTH, HEIGHT);
    moc->SetNearClipPlane(1.0f);
    moc->ClearBuffer();
    Draw(moc);
    const ClipspaceVertex behind[] = {{0, 50, 0, 200}, {-60, -60, 0, 200}, {20, -40, 0, 200}};
    const unsigned int tri[] = {0, 1, 2};
    CHECK(moc->TestTriangles((const float *)behind, tri, 1) == MOC::VISIBLE);
    moc->RenderTriangles((const float *)behind, tri, 1);
    CHECK(moc->TestTriangles((const float *)behind, tri, 1) == MOC::VISIBLE); // contents do not hide themselves
    CHECK(moc->TestRect(-0.6f, -0.6f, -0.4f, -0.5f, 150) == MOC::OCCLUDED);

    std::vector<float> depth(WIDTH * HEIGHT);
    moc->ComputePixelDepthBuffer(depth.data(), false);
    CHECK(At(depth, 0.8f, 0.1f) > 0.0f);    // across the near plane
    CHECK(At(depth, 0.72f, -0.72f) > 0.0f); // the clockwise one
    CHECK(At(depth, -0.5f, -0.5f) > 0.0f);  // the quad
    CHECK(At(depth, 0.95f, -0.95f) > 0.0f); // the one with separate arrays
    CHECK(At(depth, 0.0f, 0.1f) > 0.0f && At(depth, 0.0f, 0.1f) <= 0.005f);
    CHECK(At(depth, -0.9f, 0.9f) < 0.0f && At(depth, 0.0f, -0.9f) < 0.0f);
    return depth;
}

// Programs set it at startup for their whole lifetime. The bits do not depend on it.
void FlushingDenormals(MOC *moc)
{
    const std::vector<float> before = Example(moc);
#if HAS_MXCSR
    const unsigned int mode = _mm_getcsr();
    _mm_setcsr(mode | 0x8040);
    CHECK(Example(moc) == before);
    CHECK_EQ(_mm_getcsr() & 0x8040, 0x8040); // and the library preserves it
    _mm_setcsr(mode);
#endif
}

// As in a benchmark: as many threads as processors less one, as many rows of bins, and the object may already have
// contents. The object is never destroyed through the pool.
void PoolOf(MOC *moc, unsigned int threads)
{
    enum { N = 3000 };
    std::vector<float> vertices(12 * N), direct(WIDTH * HEIGHT), pooled(WIDTH * HEIGHT);
    std::vector<unsigned int> indices(3 * N);
    random_triangles(vertices.data(), indices.data(), N, 5);
    moc->ClearBuffer();
    moc->RenderTriangles(vertices.data(), indices.data(), N, nullptr, MOC::BACKFACE_CW, MOC::CLIP_PLANE_NONE);
    moc->ComputePixelDepthBuffer(direct.data(), false);

    CullingThreadpool pool(threads, 2, threads);
    pool.SetBuffer(moc);
    pool.WakeThreads();
    for (int frame = 0; frame < 2; frame++) {
        pool.ClearBuffer();
        pool.RenderTriangles(vertices.data(), indices.data(), N, MOC::BACKFACE_CW, MOC::CLIP_PLANE_NONE);
        pool.Flush();
        moc->ComputePixelDepthBuffer(pooled.data(), false);
        CHECK(pooled == direct);
    }
    pool.SuspendThreads();
}

// The pool's header always included these, and programs use them without an include of their own.
unsigned int Processors()
{
    std::mutex mutex;
    std::condition_variable changed;
    std::atomic<bool> ready(false);
    std::thread other([&] {
        std::lock_guard<std::mutex> lock(mutex);
        ready = true;
        changed.notify_one();
    });
    {
        std::unique_lock<std::mutex> lock(mutex);
        changed.wait(lock, [&] { return ready.load(); });
    }
    other.join();
    return std::thread::hardware_concurrency();
}

} // namespace

int main(int, char **)
{
    MOC *moc = MOC::Create();
    CHECK(moc != nullptr);
    Enumerations(moc);
    FlushingDenormals(moc);
    const unsigned int processors = Processors();
    PoolOf(moc, 0);
    PoolOf(moc, 1);
    PoolOf(moc, processors > 4 ? 3 : processors);
    MOC::Destroy(moc);
    return check_report("their_programs");
}
