// Pools and an engine's own threads: matrix and layout belong to the thread that sets them or to the call, the engine's
// jobs do the pool's work, and worker threads have names and run a callback when they start.
#include "check.h"
#include "deadline.h"

#include "CullingThreadpool.h"

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#ifdef __linux__
#include <pthread.h>
#endif

namespace
{

typedef MaskedOcclusionCulling MOC;
typedef CullingThreadpool Pool;

const float WALL[16] = {-15, -15, 0, 5, 15, -15, 0, 5, 15, 15, 0, 5, -15, 15, 0, 5};
// With IN_FRONT (w = 3) it is nearer than the wall, with BEHIND (w = 50) behind it.
const float MODEL[12] = {-0.5f, -0.5f, 1, 0.5f, -0.5f, 1, 0, 0.5f, 1};
const float IN_FRONT[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0};
const float BEHIND[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 50, 0, 0, 0, 0};
const MOC::VertexLayout PACKED(12, 4, 8);

MOC *Make(unsigned int width = 640, unsigned int height = 480)
{
    MOC *moc = MOC::Create();
    if (moc == nullptr)
        abort();
    moc->SetResolution(width, height);
    return moc;
}

std::vector<float> Depth(const MOC *moc)
{
    unsigned int width = 0, height = 0;
    moc->GetResolution(width, height);
    std::vector<float> depth(static_cast<size_t>(width) * height);
    moc->ComputePixelDepthBuffer(depth.data(), false);
    return depth;
}

// Two threads test concurrently, one in front of the wall and one behind it: neither is ever tested with the other's
// matrix.
void EachThreadItsMatrix()
{
    MOC *moc = Make();
    Pool pool(1, 4, 4);
    pool.SetBuffer(moc);
    pool.RenderTriangles(WALL, QUAD, 2);
    pool.Flush();
    const auto test = [&](const float *matrix, MOC::CullingResult expected, bool as_arguments) {
        int wrong = 0;
        for (int i = 0; i < 20000; i++) {
            if (as_arguments) {
                wrong += pool.TestTriangles(MODEL, QUAD, 1, matrix, MOC::BACKFACE_NONE, MOC::CLIP_PLANE_ALL, PACKED) != expected;
            } else {
                pool.SetMatrix(matrix);
                pool.SetVertexLayout(PACKED);
                wrong += pool.TestTriangles(MODEL, QUAD, 1, MOC::BACKFACE_NONE) != expected;
            }
        }
        return wrong;
    };
    for (bool as_arguments : {false, true}) {
        int behind = -1;
        std::thread other([&] { behind = test(BEHIND, MOC::OCCLUDED, as_arguments); });
        CHECK_EQ(test(IN_FRONT, MOC::VISIBLE, as_arguments), 0);
        other.join();
        CHECK_EQ(behind, 0);
    }
    // One thread may set up and another draw; pools share no state.
    Pool second(0, 1, 1);
    MOC *empty = Make();
    second.SetBuffer(empty);
    pool.SetMatrix(BEHIND);
    second.SetMatrix(IN_FRONT);
    second.SetVertexLayout(PACKED);
    std::thread([&] {
        CHECK(pool.TestTriangles(MODEL, QUAD, 1, MOC::BACKFACE_NONE) == MOC::OCCLUDED);
        second.RenderTriangles(MODEL, QUAD, 1, MOC::BACKFACE_NONE);
    }).join();
    second.Flush();
    CHECK(empty->TestRect(-0.01f, -0.05f, 0.01f, -0.04f, 4) == MOC::OCCLUDED);
    CHECK(empty->TestRect(-0.01f, -0.05f, 0.01f, -0.04f, 2) == MOC::VISIBLE);
    pool.SetBuffer(nullptr);
    second.SetBuffer(nullptr);
    MOC::Destroy(moc);
    MOC::Destroy(empty);
}

// The calls that take matrix and layout, with and without the length of the vertices: the same pixels as from the same
// calls on an object.
void CallsWithTheirMatrix()
{
    MOC *one = Make(), *many = Make();
    Pool pool(1, 4, 4);
    pool.SetBuffer(many);
    pool.WakeThreads();
    pool.SetMatrix(BEHIND); // must not affect any of them
    pool.SetVertexLayout(MOC::VertexLayout(4, 8, 12));
    one->RenderTriangles(MODEL, QUAD, 1, IN_FRONT, MOC::BACKFACE_NONE, MOC::CLIP_PLANE_ALL, PACKED);
    pool.RenderTriangles(MODEL, QUAD, 1, IN_FRONT, MOC::BACKFACE_NONE, MOC::CLIP_PLANE_ALL, PACKED);
    pool.Flush();
    CHECK(Depth(one) == Depth(many));
    one->RenderTriangles(WALL, QUAD, 2);
    pool.RenderTriangles(WALL, QUAD, 2, nullptr);
    pool.Flush();
    CHECK(Depth(one) == Depth(many));
    pool.SetBuffer(nullptr);

    MOC_Threadpool *plain = nullptr;
    CHECK_EQ(MOC_ThreadpoolCreate(0, 2, 2, 4, 0, &plain), MOC_STATUS_OK);
    int32_t result = MOC_OCCLUDED;
    MOC_Mesh model = {}, wall = {};
    model.size = wall.size = sizeof(model);
    model.vertices = MODEL;
    model.vertex_count = 3;
    model.indices = wall.indices = QUAD;
    model.triangle_count = 1;
    model.model_to_clip = IN_FRONT;
    model.clip_planes = wall.clip_planes = MOC_CLIP_PLANE_ALL;
    wall.vertices = WALL;
    wall.vertex_count = MOC_UNCHECKED;
    wall.triangle_count = 2;
    CHECK_EQ(MOC_ThreadpoolRenderMesh(plain, &model), MOC_STATUS_NO_BUFFER);
    CHECK_EQ(MOC_ThreadpoolTestMesh(plain, &model, &result), MOC_STATUS_NO_BUFFER);
    CHECK_EQ(result, MOC_VISIBLE);
    CHECK_EQ(MOC_ThreadpoolRenderMesh(nullptr, &model), MOC_STATUS_NULL_POINTER);
    many->ClearBuffer();
    CHECK_EQ(MOC_ThreadpoolSetBuffer(plain, many), MOC_STATUS_OK);
    CHECK_EQ(MOC_ThreadpoolRenderMesh(plain, nullptr), MOC_STATUS_NULL_POINTER);
    MOC_Mesh wrong = model;
    wrong.vertex_count = 2;
    CHECK_EQ(MOC_ThreadpoolRenderMesh(plain, &wrong), MOC_STATUS_INDEX_OUT_OF_RANGE);
    CHECK_EQ(MOC_ThreadpoolTestMesh(plain, &wrong, &result), MOC_STATUS_INDEX_OUT_OF_RANGE);
    CHECK_EQ(result, MOC_VISIBLE);
    wrong.triangle_count = static_cast<uint32_t>(-1);
    CHECK_EQ(MOC_ThreadpoolRenderMesh(plain, &wrong), MOC_STATUS_INVALID_SIZE);
    wrong = model;
    wrong.winding = 9;
    CHECK_EQ(MOC_ThreadpoolRenderMesh(plain, &wrong), MOC_STATUS_INVALID_ENUM);
    CHECK_EQ(MOC_ThreadpoolRenderMesh(plain, &model), MOC_STATUS_OK);
    CHECK_EQ(MOC_ThreadpoolFlush(plain), MOC_STATUS_OK);
    CHECK_EQ(MOC_ThreadpoolTestMesh(plain, &model, &result), MOC_STATUS_OK);
    CHECK_EQ(result, MOC_VISIBLE);
    CHECK_EQ(MOC_ThreadpoolRenderMesh(plain, &wall), MOC_STATUS_OK);
    CHECK_EQ(MOC_ThreadpoolFlush(plain), MOC_STATUS_OK);
    model.model_to_clip = BEHIND;
    CHECK_EQ(MOC_ThreadpoolTestMesh(plain, &model, &result), MOC_STATUS_OK);
    CHECK_EQ(result, MOC_OCCLUDED);
    CHECK(Depth(one) == Depth(many));
    CHECK_EQ(MOC_ThreadpoolDestroy(plain), MOC_STATUS_OK);
    MOC::Destroy(one);
    MOC::Destroy(many);
}

// A pool without worker threads: three jobs of the program do its work.
void WorkOfTheProgramsOwnThreads()
{
    enum { TRIANGLES = 3000, CALLS = 30, FRAMES = 12 };
    std::vector<float> vertices(12 * TRIANGLES);
    std::vector<unsigned int> indices(3 * TRIANGLES);
    random_triangles(vertices.data(), indices.data(), TRIANGLES, 5);
    MOC *one = Make(), *many = Make();
    MOC_ThreadpoolSettings settings = {};
    settings.size = sizeof settings;
    settings.external_threads = 3;
    Pool pool(settings);
    pool.SetBuffer(many);
    CHECK_EQ(pool.GetNumThreads(), 0);
    unsigned int w = 0, h = 0;
    pool.GetNumBins(w, h);
    CHECK(w * h > 1 && w * h <= 12);
    CHECK(!pool.WorkOnce()); // nothing to do
    std::atomic<bool> done(false);
    std::atomic<int> pieces(0);
    std::vector<std::thread> jobs;
    for (int number = 0; number < 3; number++)
        jobs.emplace_back([&] {
            while (!done) {
                if (pool.WorkOnce())
                    pieces++;
                else
                    std::this_thread::yield();
            }
        });
    int wrong = 0;
    for (int frame = 0; frame < FRAMES; frame++) {
        pool.ClearBuffer();
        one->ClearBuffer();
        for (int call = 0; call < CALLS; call++) {
            const int n = call % 3 == 0 ? TRIANGLES : 12;
            pool.RenderTriangles(vertices.data(), indices.data(), n, nullptr, MOC::BACKFACE_NONE);
            one->RenderTriangles(vertices.data(), indices.data(), n, nullptr, MOC::BACKFACE_NONE);
        }
        // A flush that never sleeps.
        while (!pool.IsDone())
            if (!pool.WorkOnce())
                std::this_thread::yield();
        wrong += Depth(many) != Depth(one);
    }
    done = true;
    for (std::thread &job : jobs)
        job.join();
    CHECK_EQ(wrong, 0);
    CHECK(pieces > 0);
    pool.SetBuffer(nullptr);
    MOC::Destroy(one);
    MOC::Destroy(many);
}

struct Started
{
    std::atomic<unsigned int> count{0}, numbers{0};
    std::atomic<bool> named{true};
};

extern "C" void Start(void *user, uint32_t number)
{
    Started *started = static_cast<Started *>(user);
    started->count++;
    started->numbers |= 1u << number;
#ifdef __linux__
    char name[32] = "";
    pthread_getname_np(pthread_self(), name, sizeof name);
    if (std::string(name) != "engine/" + std::string(" ") + std::to_string(number))
        started->named = false;
#endif
}

// The number of threads, their names, and that each runs the callback when it starts.
void Threads()
{
    for (unsigned int threads : {0u, 1u, 3u}) {
        Started started;
        MOC_ThreadpoolSettings settings = {};
        settings.size = sizeof settings;
        settings.threads = threads;
        settings.processors = threads + 1;
        settings.thread_name = "engine/";
        settings.thread_start = Start;
        settings.user = &started;
        {
            Pool pool(settings);
            CHECK_EQ(pool.GetNumThreads(), threads);
            pool.WakeThreads();
        }
        CHECK_EQ(started.count.load(), threads);
        CHECK_EQ(started.numbers.load(), (1u << threads) - 1);
        CHECK(started.named);
    }
    // Fewer if there are fewer processors.
    Pool pool(8, 4, 4, 32, 3);
    CHECK_EQ(pool.GetNumThreads(), 2);
    unsigned int w = 7, h = 7;
    pool.GetNumBins(w, h);
    CHECK_EQ(w + h, 0);

    MOC_ThreadpoolSettings settings = {};
    MOC_Threadpool *plain = nullptr;
    uint32_t count = 0;
    CHECK_EQ(MOC_ThreadpoolCreateFrom(&settings, &plain), MOC_STATUS_INVALID_SIZE);
    CHECK_EQ(MOC_ThreadpoolCreateFrom(nullptr, &plain), MOC_STATUS_NULL_POINTER);
    settings.size = sizeof settings;
    CHECK_EQ(MOC_ThreadpoolCreateFrom(&settings, nullptr), MOC_STATUS_NULL_POINTER);
    settings.threads = 1025;
    CHECK_EQ(MOC_ThreadpoolCreateFrom(&settings, &plain), MOC_STATUS_INVALID_SIZE);
    settings.threads = 0;
    settings.reserved = 1;
    CHECK_EQ(MOC_ThreadpoolCreateFrom(&settings, &plain), MOC_STATUS_INVALID_ENUM);
    settings.reserved = 0;
    CHECK(plain == nullptr);
    CHECK_EQ(MOC_ThreadpoolCreateFrom(&settings, &plain), MOC_STATUS_OK);
    CHECK_EQ(MOC_ThreadpoolGetThreads(plain, &count), MOC_STATUS_OK);
    CHECK_EQ(MOC_ThreadpoolGetThreads(plain, nullptr), MOC_STATUS_NULL_POINTER);
    CHECK_EQ(MOC_ThreadpoolGetBins(plain, &w, &h), MOC_STATUS_NO_BUFFER);
    CHECK_EQ(MOC_ThreadpoolGetBins(plain, nullptr, &h), MOC_STATUS_NULL_POINTER);
    CHECK_EQ(MOC_ThreadpoolIsDone(plain, nullptr), MOC_STATUS_NULL_POINTER);
    CHECK_EQ(MOC_ThreadpoolWorkOnce(plain, nullptr), MOC_STATUS_OK);
    CHECK_EQ(MOC_ThreadpoolWorkOnce(nullptr, nullptr), MOC_STATUS_NULL_POINTER);
    CHECK_EQ(MOC_ThreadpoolDestroy(plain), MOC_STATUS_OK);
}

} // namespace

int main()
{
    deadline(300);
    EachThreadItsMatrix();
    CallsWithTheirMatrix();
    WorkOfTheProgramsOwnThreads();
    Threads();
    return check_report("pool_threads");
}
