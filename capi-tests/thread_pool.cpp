// The thread pool through its C++ class: the same pixels as from one thread, whichever thread submits, sleeps, clears
// or resizes and when, and no call that hangs. These are defects 12 (columns and rows lost if the size is not a
// multiple of the tile) and 13 (races, lost work, hangs) of Intel's library.
#include "check.h"
#include "deadline.h"

// Matrices and layouts are combined at random.
#define MOC_CHECK_LAYOUT 0
#include "CullingThreadpool.h"

#include <atomic>
#include <limits>
#include <thread>
#include <vector>

namespace
{

typedef MaskedOcclusionCulling MOC;

const int32_t IMPLEMENTATIONS[] = {MOC_SCALAR, MOC_SSE2, MOC_SSE41, MOC_AVX2, MOC_AVX512};
const int N_RULES = 4;
const int32_t RULES[N_RULES] = {MOC_UPDATE_RULE_THREE_LAYER, MOC_UPDATE_RULE_QUICK, MOC_UPDATE_RULE_ACCURATE,
                                MOC_UPDATE_RULE_FOUR_LAYER};

MOC *Make(unsigned int width, unsigned int height, int32_t implementation = MOC_AVX512,
          int32_t rule = MOC_UPDATE_RULE_THREE_LAYER)
{
    MOC_Settings settings = {};
    settings.size = sizeof(settings);
    MOC_DefaultSettings(&settings);
    settings.implementation = implementation;
    settings.update_rule = rule;
    MOC *moc = nullptr;
    CHECK_EQ(MOC_Create(&settings, &moc), MOC_STATUS_OK);
    if (moc == nullptr)
        abort();
    if (width != 0)
        moc->SetResolution(width, height);
    return moc;
}

struct Mesh
{
    std::vector<float> vertices;
    std::vector<unsigned int> indices;

    // Triangles all around the view and beyond it.
    Mesh(int triangles, uint32_t seed) : vertices(12 * triangles), indices(3 * triangles)
    {
        random_triangles(vertices.data(), indices.data(), triangles, seed);
    }

    // A rectangle at a distance.
    Mesh(float xmin, float ymin, float xmax, float ymax, float w) : vertices(16), indices(QUAD, QUAD + 6)
    {
        quad_at(vertices.data(), xmin, ymin, xmax, ymax, w);
    }

    int Triangles() const { return static_cast<int>(indices.size() / 3); }
};

template <class Target> void Draw(Target &target, const Mesh &mesh)
{
    target.RenderTriangles(mesh.vertices.data(), mesh.indices.data(), mesh.Triangles(), MOC::BACKFACE_NONE);
}

// The methods of a pool, on one object and in the calling thread: the reference for the pool.
class Direct
{
public:
    explicit Direct(MOC *moc) : mMoc(moc) {}
    void WakeThreads() {}
    void SuspendThreads() {}
    void Flush() {}
    void SetResolution(unsigned int width, unsigned int height) { mMoc->SetResolution(width, height); }
    void SetNearClipPlane(float near) { mMoc->SetNearClipPlane(near); }
    void SetMatrix(const float *matrix = nullptr)
    {
        mHasMatrix = matrix != nullptr;
        if (mHasMatrix)
            memcpy(mMatrix, matrix, sizeof mMatrix);
    }
    void SetVertexLayout(const MOC::VertexLayout &layout = MOC::VertexLayout(16, 4, 12)) { mLayout = layout; }
    void ClearBuffer() { mMoc->ClearBuffer(); }
    void RenderTriangles(const float *vertices, const unsigned int *indices, int triangles,
                         MOC::BackfaceWinding winding = MOC::BACKFACE_CW,
                         MOC::ClipPlanes planes = MOC::CLIP_PLANE_ALL)
    {
        mMoc->RenderTriangles(vertices, indices, triangles, mHasMatrix ? mMatrix : nullptr, winding, planes, mLayout);
    }
    void MergeBuffers(const MOC *const *others, unsigned int count) { mMoc->MergeBuffers(others, count); }
    void ComputePixelDepthBuffer(float *depth, bool flip) { mMoc->ComputePixelDepthBuffer(depth, flip); }

private:
    MOC *mMoc;
    bool mHasMatrix = false;
    float mMatrix[16];
    MOC::VertexLayout mLayout = MOC::VertexLayout(16, 4, 12);
};

// The pixels, from an object or a pool that draws into `moc`.
template <class Target> std::vector<float> Depth(Target &target, const MOC *moc)
{
    unsigned int width = 0, height = 0;
    moc->GetResolution(width, height);
    std::vector<float> depth(static_cast<size_t>(width) * height, -7.0f);
    target.ComputePixelDepthBuffer(depth.data(), false);
    return depth;
}

std::vector<float> Depth(MOC *moc)
{
    return Depth(*moc, moc);
}

bool Same(const std::vector<float> &a, const std::vector<float> &b)
{
    return a.size() == b.size() && memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

bool Occluded(MOC::CullingResult result)
{
    return result == MOC::OCCLUDED;
}

struct Size
{
    unsigned int width, height;
};

// Every number of threads and bins, at sizes that are not multiples of anything. The far wall covers every pixel.
void SameAsOneThread()
{
    const Mesh wall(-2, -2, 2, 2, 30), many(2500, 1), few(100, 2);
    const Size sizes[] = {{1023, 517}, {1, 1}, {33, 9}};
    const unsigned int threads[] = {0, 1, 2, 5}, bins[][2] = {{1, 1}, {4, 4}, {7, 3}, {64, 64}};
    const auto frame = [&](const Mesh &first, const Mesh &second, const Mesh &third, Direct *direct,
                           CullingThreadpool *pool) {
        for (const Mesh *mesh : {&first, &second, &third}) {
            if (direct != nullptr)
                Draw(*direct, *mesh);
            else
                Draw(*pool, *mesh);
        }
    };
    for (const Size &size : sizes) {
        std::vector<float> expected[N_RULES];
        for (int rule = 0; rule < N_RULES; rule++) {
            MOC *moc = Make(size.width, size.height, MOC_AVX512, RULES[rule]);
            Direct direct(moc);
            frame(few, wall, many, &direct, nullptr);
            expected[rule] = Depth(moc);
            MOC::Destroy(moc);
            size_t bare = 0;
            for (float depth : expected[rule])
                bare += !(depth > 0.0f);
            CHECK_EQ(bare, 0);
        }
        int turn = 0;
        for (unsigned int t : threads) {
            for (const unsigned int *b : bins) {
                const int rule = turn % N_RULES;
                MOC *moc = Make(size.width, size.height, IMPLEMENTATIONS[turn++ % 5], RULES[rule]);
                CullingThreadpool pool(t, b[0], b[1], 32, t + 1);
                pool.SetBuffer(moc);
                pool.WakeThreads();
                // The second frame is the one that counts: nothing of the first may remain.
                frame(many, few, few, nullptr, &pool);
                pool.ClearBuffer();
                frame(few, wall, many, nullptr, &pool);
                pool.Flush();
                CHECK(Same(Depth(moc), expected[rule]));
                CHECK(Same(Depth(pool, moc), expected[rule]));
                pool.SetBuffer(nullptr);
                MOC::Destroy(moc);
            }
        }
    }
}

// The data that the random calls draw.
struct Props
{
    std::vector<Mesh> meshes;
    std::vector<MOC *> others;

    Props()
    {
        const int triangles[] = {1, 2, 7, 12, 12, 40, 150, 900};
        for (int n : triangles)
            meshes.emplace_back(n, static_cast<uint32_t>(n + 1));
        for (uint32_t i = 0; i < 2; i++) {
            others.push_back(Make(257, 65));
            others.back()->RenderTriangles(meshes[6 + i].vertices.data(), meshes[6 + i].indices.data(), 150, nullptr,
                                           MOC::BACKFACE_NONE);
        }
    }

    ~Props()
    {
        for (MOC *other : others)
            MOC::Destroy(other);
    }
};

// Small jobs, each with another matrix, and now and then a clear, a resize, a near plane, a merge, a pause. Matrices
// are overwritten as soon as they are set.
template <class Target>
std::vector<std::vector<float>> RandomCalls(Target &target, MOC *moc, const Props &props, uint32_t seed)
{
    const Size sizes[] = {{257, 65}, {129, 64}, {1, 1}, {33, 9}, {511, 300}};
    std::vector<std::vector<float>> pixels;
    std::vector<float> matrix(16);
    for (int call = 0; call < 300; call++) {
        const float shift[2] = {0.8f * next_unit(&seed), 0.8f * next_unit(&seed)};
        const float scale = 1.0f + 0.5f * next_unit(&seed);
        const uint32_t kind = next_random(&seed) % 100;
        const Mesh &mesh = props.meshes[next_random(&seed) % props.meshes.size()];
        if (call % 4 == 0) {
            target.SetMatrix();
            target.SetVertexLayout();
        } else {
            // The fourth float of a vertex is read as z, and becomes w.
            const float moved[16] = {scale, 0, 0, 0, 0, scale, 0, 0, shift[0], shift[1], 0, 1, 0, 0, 0, 0};
            matrix.assign(moved, moved + 16);
            target.SetMatrix(matrix.data());
            target.SetVertexLayout(MOC::VertexLayout(16, 4, 12));
            matrix.assign(16, std::numeric_limits<float>::quiet_NaN());
        }
        target.RenderTriangles(mesh.vertices.data(), mesh.indices.data(), mesh.Triangles(),
                               call % 2 == 0 ? MOC::BACKFACE_NONE : MOC::BACKFACE_CW);
        if (kind < 4)
            target.ClearBuffer();
        else if (kind < 7)
            target.SetNearClipPlane(3.0f + 2.0f * shift[0]);
        else if (kind < 9)
            target.SetResolution(sizes[call % 5].width, sizes[call % 5].height);
        else if (kind < 12)
            target.MergeBuffers(props.others.data(), 2); // rejected for other sizes
        else if (kind < 14)
            target.Flush();
        else if (kind < 16)
            target.SuspendThreads();
        else if (kind < 20)
            target.WakeThreads();
        else if (kind < 22)
            pixels.push_back(Depth(target, moc));
    }
    pixels.push_back(Depth(target, moc));
    return pixels;
}

void SmallJobs()
{
    const Props props;
    uint32_t seed = 100;
    for (unsigned int threads : {0u, 2u, 5u}) {
        for (unsigned int jobs : {1u, 2u, 32u}) {
            for (int round = 0; round < 3; round++, seed++) {
                const int32_t rule = RULES[seed % N_RULES];
                MOC *one = Make(257, 65, MOC_AVX512, rule), *many = Make(257, 65, IMPLEMENTATIONS[seed % 5], rule);
                Direct direct(one);
                const std::vector<std::vector<float>> expected = RandomCalls(direct, one, props, seed);
                {
                    CullingThreadpool pool(threads, 3, 2, jobs, threads + 1);
                    pool.SetBuffer(many);
                    pool.WakeThreads();
                    const std::vector<std::vector<float>> pixels = RandomCalls(pool, many, props, seed);
                    CHECK_EQ(pixels.size(), expected.size());
                    for (size_t i = 0; i < pixels.size() && i < expected.size(); i++)
                        CHECK(Same(pixels[i], expected[i]));
                    pool.Flush();
                    CHECK(one->GetNearClipPlane() == many->GetNearClipPlane());
                }
                MOC::Destroy(one);
                MOC::Destroy(many);
            }
        }
    }
}

// Destroyed while awake, while suspended, never woken, and with nothing to do: everything submitted is drawn.
void Destroyed()
{
    enum { CALLS = 30 };
    const Mesh mesh(200, 5);
    MOC *one = Make(640, 360);
    Direct direct(one);
    for (int i = 0; i < CALLS; i++)
        Draw(direct, mesh);
    const std::vector<float> expected = Depth(one);
    for (int way = 0; way < 60; way++) {
        MOC *many = Make(640, 360);
        {
            CullingThreadpool pool(static_cast<unsigned int>(way % 4), 4, 4, way % 2 == 0 ? 32 : 2, 4);
            pool.SetBuffer(many);
            if (way % 3 != 0)
                pool.WakeThreads();
            for (int i = 0; i < CALLS; i++)
                Draw(pool, mesh);
            if (way % 3 == 1)
                pool.SuspendThreads();
        }
        if (way % 5 == 0) // the pixels are the slow part
            CHECK(Same(Depth(many), expected));
        CHECK(many->TestRect(-0.1f, -0.1f, 0.1f, 0.1f, 100) == one->TestRect(-0.1f, -0.1f, 0.1f, 0.1f, 100));
        MOC::Destroy(many);
    }
    for (unsigned int threads = 0; threads < 6; threads++) {
        CullingThreadpool asleep(threads, 2, 2, 32, threads + 1), awake(threads, 2, 2, 32, threads + 1);
        awake.WakeThreads();
    }
    MOC::Destroy(one);
}

// Threads that are woken twice, suspended twice, flushed while suspended or with nothing to do, and more threads than
// bins.
void SleepAndWake()
{
    const Mesh mesh(300, 6), one_triangle(1, 8);
    for (unsigned int threads : {0u, 1u, 2u, 5u}) {
        MOC *one = Make(200, 100), *many = Make(200, 100);
        Direct direct(one);
        CullingThreadpool pool(threads, 1, 1, 32, threads + 1);
        pool.Flush();
        pool.SetBuffer(many);
        pool.Flush();
        const auto draws = [&] {
            Draw(direct, mesh);
            Draw(pool, mesh);
            Draw(direct, one_triangle);
            Draw(pool, one_triangle);
        };
        const auto flushed = [&] {
            pool.Flush();
            CHECK(Same(Depth(many), Depth(one)));
            pool.Flush();
        };
        draws(); // not woken yet
        flushed();
        pool.WakeThreads();
        pool.WakeThreads();
        draws();
        flushed();
        for (int i = 0; i < 50; i++) { // a few triangles, then a flush at once
            Draw(direct, one_triangle);
            Draw(pool, one_triangle);
            pool.Flush();
        }
        flushed();
        pool.SuspendThreads();
        draws();
        flushed();
        pool.SuspendThreads();
        draws();
        pool.WakeThreads();
        flushed();
        draws();
        pool.SuspendThreads(); // with work in flight
        flushed();
        for (int i = 0; i < 100; i++) {
            pool.WakeThreads();
            draws();
            pool.SuspendThreads();
        }
        flushed();
        pool.SetBuffer(nullptr);
        MOC::Destroy(one);
        MOC::Destroy(many);
    }
    // Suspended by one thread while another waits.
    MOC *moc = Make(640, 360);
    CullingThreadpool pool(2, 4, 4, 2, 3);
    pool.SetBuffer(moc);
    std::atomic<bool> done(false);
    std::thread restless([&] {
        for (int i = 0; !done; i++) {
            pool.WakeThreads();
            if (i % 2 == 0)
                std::this_thread::yield();
            pool.SuspendThreads();
        }
    });
    for (int i = 0; i < 100; i++) {
        Draw(pool, mesh);
        pool.Flush();
    }
    done = true;
    restless.join();
    pool.SetBuffer(nullptr);
    MOC::Destroy(moc);
}

// When ClearBuffer returns, earlier contents hide nothing, whether or not the clear has been performed.
void AfterClear()
{
    const Mesh wall(-2, -2, 2, 2, 10), left(-2, -2, 0, 2, 10), behind(0.2f, -0.4f, 0.6f, 0.4f, 20), noise(400, 9);
    for (unsigned int threads : {0u, 1u, 3u}) {
        MOC *moc = Make(500, 300);
        CullingThreadpool pool(threads, 4, 4, 32, threads + 1);
        pool.SetBuffer(moc);
        int lies = 0, lost = 0;
        const auto rect = [&] { return Occluded(pool.TestRect(0.2f, -0.4f, 0.6f, 0.4f, 20)); };
        const auto triangles = [&] {
            return Occluded(pool.TestTriangles(behind.vertices.data(), behind.indices.data(), 2, MOC::BACKFACE_NONE));
        };
        for (int round = 0; round < 60; round++) {
            if (round % 3 == 0)
                pool.SuspendThreads(); // the clear is not performed before the flush
            else
                pool.WakeThreads();
            Draw(pool, wall);
            pool.Flush();
            lost += !rect() + !triangles();
            for (int i = 0; i < round % 4; i++)
                Draw(pool, noise);
            pool.ClearBuffer();
            lies += rect() + triangles();
            // Only the left half is drawn now.
            Draw(pool, left);
            lies += rect() + triangles();
            pool.ClearBuffer();
            Draw(pool, left);
            lies += rect() + triangles();
            if (round % 2 == 0)
                pool.Flush();
            lies += rect() + triangles();
        }
        CHECK_EQ(lies, 0);
        CHECK_EQ(lost, 0);
        pool.SetBuffer(nullptr);
        MOC::Destroy(moc);
    }
}

// Three threads query while another one submits and clears: each answer must be valid at some moment. Everything drawn
// is in the left half, between 5 and 15 away.
void QueriesMeanwhile()
{
    enum { ASKING = 3, FRAMES = 60, CALLS = 20 };
    std::vector<Mesh> meshes;
    uint32_t seed = 11;
    for (int i = 0; i < CALLS; i++) {
        const float y = next_unit(&seed), w = 10.0f + 5.0f * next_unit(&seed);
        meshes.emplace_back(-1.5f, y - 0.5f, -0.05f, y + 0.5f, w);
    }
    MOC *one = Make(1000, 500), *many = Make(1000, 500);
    CullingThreadpool pool(2, 4, 4, 4, 3);
    pool.SetBuffer(many);
    pool.WakeThreads();
    std::atomic<bool> done(false);
    std::atomic<int> lies(0), asked(0);
    std::vector<std::thread> asking;
    for (int number = 0; number < ASKING; number++)
        asking.emplace_back([&, number] {
            uint32_t state = static_cast<uint32_t>(number);
            while (!done) {
                const float x = 0.4f * (next_unit(&state) + 1.0f), y = 0.9f * next_unit(&state);
                const Mesh near(-0.05f - x, y - 0.1f, 0, y + 0.1f, 4);
                const Mesh right(x + 0.01f, y - 0.1f, x + 0.1f, y + 0.1f, 50);
                const Mesh far(-x - 0.1f, y - 0.1f, -x - 0.05f, y + 0.1f, 50);
                const auto test = [&](const Mesh &mesh) {
                    return pool.TestTriangles(mesh.vertices.data(), mesh.indices.data(), 2);
                };
                lies += pool.TestRect(-0.05f - x, y - 0.1f, 0, y + 0.1f, 4) != MOC::VISIBLE;
                lies += pool.TestRect(x + 0.01f, y - 0.1f, x + 0.1f, y + 0.1f, 50) != MOC::VISIBLE;
                lies += pool.TestRect(1.5f, y - 0.1f, 1.7f, y + 0.1f, 50) != MOC::VIEW_CULLED;
                lies += pool.TestRect(-x - 0.1f, y - 0.1f, -x - 0.05f, y + 0.1f, 50) == MOC::VIEW_CULLED;
                lies += test(near) != MOC::VISIBLE;
                lies += test(right) != MOC::VISIBLE;
                lies += test(far) == MOC::VIEW_CULLED;
                asked++;
            }
        });
    Direct direct(one);
    for (int frame = 0; frame < FRAMES || asked < 200; frame++) {
        pool.ClearBuffer();
        for (const Mesh &mesh : meshes)
            Draw(pool, mesh);
        if (frame % 3 == 0)
            pool.Flush();
        if (frame % 16 == 0)
            pool.SetResolution(1000, 500);
    }
    done = true;
    for (std::thread &thread : asking)
        thread.join();
    pool.ClearBuffer();
    for (const Mesh &mesh : meshes) {
        Draw(direct, mesh);
        Draw(pool, mesh);
    }
    pool.Flush();
    CHECK_EQ(lies.load(), 0);
    CHECK(Same(Depth(many), Depth(one)));

    // With nothing in flight the pool's answers are the object's.
    int differ = 0, hidden = 0;
    for (int i = 0; i < 2000; i++) {
        const float x = next_unit(&seed), y = next_unit(&seed), w = 10.0f + 9.0f * next_unit(&seed);
        const Mesh mesh(x, y, x + 0.1f, y + 0.1f, w);
        const MOC::CullingResult rect = one->TestRect(x, y, x + 0.1f, y + 0.1f, w),
                                 quad = one->TestTriangles(mesh.vertices.data(), mesh.indices.data(), 2);
        differ += pool.TestRect(x, y, x + 0.1f, y + 0.1f, w) != rect;
        differ += pool.TestTriangles(mesh.vertices.data(), mesh.indices.data(), 2) != quad;
        hidden += Occluded(rect);
    }
    CHECK_EQ(differ, 0);
    CHECK(hidden > 100);
    pool.SetBuffer(nullptr);
    MOC::Destroy(one);
    MOC::Destroy(many);
}

// Two threads submit concurrently. In whichever order their calls arrive, the pixels are the same: both draw the same
// triangles, or each has one half of the screen, and no tile crosses the boundary.
void TwoSubmit()
{
    enum { CALLS = 40 };
    const Mesh same(300, 12);
    std::vector<Mesh> left, right;
    uint32_t seed = 13;
    for (int i = 0; i < CALLS; i++) {
        const float x = 0.5f * (next_unit(&seed) + 1.0f), y = next_unit(&seed), w = 10.0f + 5.0f * next_unit(&seed);
        left.emplace_back(-x, y, 0, y + 0.5f, w);
        right.emplace_back(0, y - 0.5f, x, y, w);
    }
    for (int round = 0; round < 12; round++) {
        MOC *one = Make(1024, 200), *many = Make(1024, 200);
        Direct direct(one);
        CullingThreadpool pool(round % 3 == 0 ? 0 : 2, 4, 4, round % 2 == 0 ? 32 : 1, 3);
        pool.SetBuffer(many);
        if (round % 4 != 3)
            pool.WakeThreads();
        const bool halves = round >= 6;
        for (int i = 0; i < CALLS; i++) {
            Draw(direct, halves ? left[i] : same);
            Draw(direct, halves ? right[i] : same);
        }
        const auto submit = [&](const std::vector<Mesh> *half) {
            for (int i = 0; i < CALLS; i++)
                Draw(pool, halves ? (*half)[i] : same);
            pool.Flush();
        };
        std::thread other(submit, &left);
        submit(&right);
        other.join();
        CHECK(Same(Depth(many), Depth(one)));
        pool.SetBuffer(nullptr);
        MOC::Destroy(one);
        MOC::Destroy(many);
    }
}

// Without an object, with one that has no resolution, with a new one while work is in flight, and with one whose owner
// changed its resolution.
void Buffers()
{
    const Mesh mesh(300, 14);
    float pixel = 5.0f;
    CullingThreadpool pool(2, 4, 4, 32, 3);
    pool.WakeThreads();
    const auto nothing = [&] {
        Draw(pool, mesh);
        pool.ClearBuffer();
        pool.MergeBuffers(nullptr, 0);
        pool.ComputePixelDepthBuffer(&pixel, false);
        CHECK(pixel == 5.0f);
        CHECK(pool.TestRect(-1, -1, 1, 1, 5) == MOC::VISIBLE);
        CHECK(pool.TestTriangles(mesh.vertices.data(), mesh.indices.data(), 300) == MOC::VISIBLE);
        pool.Flush();
    };
    nothing();
    pool.SetResolution(100, 100);
    pool.SetNearClipPlane(0.5f);
    MOC *one = Make(300, 200), *first = Make(0, 0), *second = Make(300, 200);
    one->SetNearClipPlane(0.5f);
    second->SetNearClipPlane(0.5f);
    Direct direct(one);
    pool.SetBuffer(first);
    CHECK(first->GetNearClipPlane() == 0.0f); // an object keeps its own
    pool.SetNearClipPlane(0.5f);
    CHECK(first->GetNearClipPlane() == 0.5f);
    nothing();
    pool.SetResolution(300, 200);
    Draw(direct, mesh);
    Draw(pool, mesh);
    pool.SetBuffer(second);
    CHECK(Same(Depth(first), Depth(one)));
    CHECK(second->GetNearClipPlane() == 0.5f);
    Draw(pool, mesh);
    pool.SetBuffer(nullptr);
    CHECK(Same(Depth(second), Depth(one)));
    nothing();

    pool.SetBuffer(first);
    const Size sizes[] = {{1023, 517}, {1, 1}, {640, 360}, {33, 9}};
    for (const Size &size : sizes) {
        Draw(pool, mesh);
        pool.Flush();
        one->SetResolution(size.width, size.height);
        first->SetResolution(size.width, size.height);
        Draw(direct, mesh);
        Draw(pool, mesh);
        CHECK(Same(Depth(pool, first), Depth(one)));
        // Rejected: the old size and contents stay.
        pool.SetResolution(0, 5);
        pool.SetResolution(5, 16385);
        CHECK(Same(Depth(pool, first), Depth(one)));
        // Set to the same size: cleared, with work in flight.
        Draw(pool, mesh);
        pool.SetResolution(size.width, size.height);
        one->ClearBuffer();
        CHECK(Same(Depth(pool, first), Depth(one)));
    }
    pool.SetBuffer(nullptr);
    MOC::Destroy(first);
    MOC::Destroy(second);
    MOC::Destroy(one);
}

// Invalid arguments, through the class and with statuses: nothing is drawn, and the pool keeps working.
void Refused()
{
    const Mesh wall(-2, -2, 2, 2, 10);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float *vertices = wall.vertices.data();
    const unsigned int *indices = wall.indices.data();
    CullingThreadpool none(0, 0, 0, 0), pool(2, 2, 2); // zeros count as ones
    MOC_Threadpool *plain = nullptr;
    CHECK_EQ(MOC_ThreadpoolCreate(2, 2, 2, 4, 0, &plain), MOC_STATUS_OK);
    MOC *moc = Make(200, 100), *other = Make(200, 104);
    const std::vector<float> empty = Depth(moc);
    pool.SetBuffer(moc);
    pool.WakeThreads();
    pool.RenderTriangles(nullptr, indices, 2);
    pool.RenderTriangles(vertices, nullptr, 2);
    pool.RenderTriangles(vertices, indices, -1);
    pool.RenderTriangles(nullptr, nullptr, 0);
    pool.SetVertexLayout(MOC::VertexLayout(-16, 4, 12));
    pool.SetNearClipPlane(nan);
    pool.MergeBuffers(nullptr, 2);
    pool.MergeBuffers(&other, 1);
    pool.ComputePixelDepthBuffer(nullptr, false);
    CHECK(pool.TestTriangles(nullptr, indices, 2) == MOC::VISIBLE);
    CHECK(pool.TestTriangles(vertices, indices, -1) == MOC::VISIBLE);
    CHECK(pool.TestRect(nan, -1, 1, 1, 20) == MOC::VISIBLE);
    CHECK(Same(Depth(pool, moc), empty));
    Draw(pool, wall);
    pool.Flush();
    CHECK(Occluded(pool.TestRect(-0.5f, -0.5f, 0.5f, 0.5f, 20)));
    pool.ClearBuffer();
    pool.SetBuffer(nullptr);

    CHECK_EQ(MOC_ThreadpoolSetBuffer(plain, moc), MOC_STATUS_OK);
    CHECK_EQ(MOC_ThreadpoolWakeThreads(plain), MOC_STATUS_OK);
    const int32_t all = MOC_CLIP_PLANE_ALL, cw = MOC_BACKFACE_CW;
    int32_t result = MOC_OCCLUDED;
    CHECK_EQ(MOC_ThreadpoolRenderTriangles(plain, nullptr, indices, 2, cw, all), MOC_STATUS_NULL_POINTER);
    CHECK_EQ(MOC_ThreadpoolRenderTriangles(plain, vertices, nullptr, 2, cw, all), MOC_STATUS_NULL_POINTER);
    CHECK_EQ(MOC_ThreadpoolRenderTriangles(plain, vertices, indices, -1, cw, all), MOC_STATUS_INVALID_SIZE);
    CHECK_EQ(MOC_ThreadpoolRenderTriangles(plain, vertices, indices, INT32_MIN, cw, all), MOC_STATUS_INVALID_SIZE);
    CHECK_EQ(MOC_ThreadpoolRenderTriangles(plain, vertices, indices, 2, 7, all), MOC_STATUS_INVALID_ENUM);
    CHECK_EQ(MOC_ThreadpoolRenderTriangles(plain, nullptr, nullptr, 0, cw, all), MOC_STATUS_OK);
    CHECK_EQ(MOC_ThreadpoolTestTriangles(plain, vertices, indices, -1, cw, all, &result), MOC_STATUS_INVALID_SIZE);
    CHECK_EQ(result, MOC_VISIBLE);
    CHECK_EQ(MOC_ThreadpoolFlush(plain), MOC_STATUS_OK);
    CHECK(Same(Depth(moc), empty));
    CHECK_EQ(MOC_ThreadpoolDestroy(plain), MOC_STATUS_OK);
    MOC::Destroy(moc);
    MOC::Destroy(other);
}

} // namespace

int main()
{
    deadline(120);
    SameAsOneThread();
    SmallJobs();
    Destroyed();
    SleepAndWake();
    AfterClear();
    QueriesMeanwhile();
    TwoSubmit();
    Buffers();
    Refused();
    return check_report("thread_pool");
}
