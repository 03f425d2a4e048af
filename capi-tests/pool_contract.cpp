// What engines rely on in CullingThreadpool, as promised by Intel's header: the state when a flushing call returns, how
// many arrays are in use, that awake threads draw without a further call, and that pool and object may be used side by
// side.
#include "check.h"
#include "deadline.h"

#include "CullingThreadpool.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

namespace
{

typedef MaskedOcclusionCulling MOC;
typedef CullingThreadpool Pool;

struct Wall
{
    float vertices[16];

    explicit Wall(float w, float size = 3) { quad_at(vertices, -size, -size, size, size, w); }
};

const Wall WALL(5);

bool Hidden(const MOC *moc)
{
    return moc->TestRect(-0.1f, -0.1f, 0.1f, 0.1f, 10) == MOC::OCCLUDED;
}

MOC *Make(unsigned int width = 640, unsigned int height = 480)
{
    MOC *moc = MOC::Create();
    if (moc == nullptr)
        abort();
    moc->SetResolution(width, height);
    moc->SetNearClipPlane(0.1f);
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

// A pool with two worker threads, even on a machine with two processors.
struct Setup
{
    MOC *moc;
    std::unique_ptr<Pool> pool;

    explicit Setup(unsigned int threads = 2, unsigned int jobs = 32) : moc(Make()), pool(new Pool(threads, 4, 4, jobs, 3))
    {
        pool->SetBuffer(moc);
    }

    ~Setup()
    {
        pool.reset();
        MOC::Destroy(moc);
    }

    void Draw(const Wall &wall = WALL) { pool->RenderTriangles(wall.vertices, QUAD, 2); }
};

// Polls until the condition holds. Worker threads that run at all do so within a minute.
template <class Condition> bool Soon(Condition condition)
{
    for (int i = 0; i < 60000; i++) {
        if (condition())
            return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
}

// When ClearBuffer returns, the buffer is clear, even for queries of the object itself.
void ClearThenQuery()
{
    int lies = 0;
    for (unsigned int threads : {0u, 2u}) {
        Setup s(threads);
        for (int k = 0; k < 200; k++) {
            s.pool->WakeThreads();
            s.pool->ClearBuffer();
            s.Draw();
            s.pool->Flush();
            if (k % 3 == 0)
                s.pool->SuspendThreads();
            for (int n = 0; n < k % 4; n++)
                s.Draw();
            s.pool->ClearBuffer();
            lies += Hidden(s.moc);
        }
    }
    CHECK_EQ(lies, 0);
}

// After ClearBuffer the object may be drawn into directly.
void ClearThenDraw()
{
    Setup s;
    s.pool->WakeThreads();
    int lost = 0;
    for (int k = 0; k < 200; k++) {
        s.pool->ClearBuffer();
        s.moc->RenderTriangles(WALL.vertices, QUAD, 2, nullptr, MOC::BACKFACE_NONE);
        s.pool->Flush();
        lost += !Hidden(s.moc);
    }
    CHECK_EQ(lost, 0);
}

// After each flushing call the arrays may be overwritten and freed: their previous contents have been drawn.
void FlushThenFree()
{
    MOC *other = Make();
    Setup s;
    s.pool->WakeThreads();
    int wrong = 0;
    for (int k = 0; k < 36; k++) {
        if (k % 2 == 0)
            s.pool->WakeThreads();
        std::vector<float> vertices;
        std::vector<unsigned int> indices;
        for (unsigned int i = 0; i < 100; i++) {
            vertices.insert(vertices.end(), WALL.vertices, WALL.vertices + 16);
            for (uint32_t q : QUAD)
                indices.push_back(4 * i + q);
        }
        for (int r = 0; r < 5; r++)
            s.pool->RenderTriangles(vertices.data(), indices.data(), 200);
        switch (k % 6) {
        case 0: s.pool->ClearBuffer(); break;
        case 1: s.pool->SetNearClipPlane(0.1f + 0.001f * static_cast<float>(k)); break;
        case 2: s.pool->SuspendThreads(); break;
        case 3: s.pool->SetBuffer(k % 4 == 3 ? other : s.moc); break;
        case 4: s.pool->SetResolution(640, 480); break;
        default: s.pool->Flush(); break;
        }
        // Nearer, everywhere: if it were drawn later, it would hide anything in front of the wall.
        for (unsigned int i = 0; i < 100; i++)
            quad_at(&vertices[16 * i], -3, -3, 3, 3, 1);
        wrong += s.moc->TestRect(-0.1f, -0.1f, 0.1f, 0.1f, 3) == MOC::OCCLUDED;
        std::fill(indices.begin(), indices.end(), 0x7f7f7f7fu);
    }
    CHECK_EQ(wrong, 0);
    s.pool->SetBuffer(nullptr);
    MOC::Destroy(other);
}

// The object may be destroyed before the pool or before the pool gets another object, with or without work in flight.
void DestroyInAnyOrder()
{
    for (int way = 0; way < 24; way++) {
        MOC *a = Make(), *b = Make();
        std::unique_ptr<Pool> pool(new Pool(static_cast<unsigned int>(way % 3), 4, 4, 32, 3));
        pool->SetBuffer(a);
        if (way % 2 == 0)
            pool->WakeThreads();
        for (int i = 0; i < 5; i++)
            pool->RenderTriangles(WALL.vertices, QUAD, 2);
        if (way % 4 < 2)
            pool->ClearBuffer();
        MOC::Destroy(a);
        // The pool has no object now, and calls fail silently.
        pool->RenderTriangles(WALL.vertices, QUAD, 2);
        pool->ClearBuffer();
        CHECK(pool->TestRect(-0.1f, -0.1f, 0.1f, 0.1f, 10) == MOC::VISIBLE);
        pool->Flush();
        if (way % 6 < 3) {
            pool->SetBuffer(b);
            pool->RenderTriangles(WALL.vertices, QUAD, 2);
            if (way % 6 == 0)
                pool->Flush();
        }
        pool.reset();
        // Everything submitted is drawn, and the owner may use the object directly again.
        CHECK(Hidden(b) == (way % 6 < 3));
        b->ClearBuffer();
        CHECK(!Hidden(b));
        Pool next(1, 2, 2);
        next.SetBuffer(b);
        next.RenderTriangles(WALL.vertices, QUAD, 2);
        next.Flush();
        CHECK(Hidden(b));
        next.SetBuffer(nullptr);
        MOC::Destroy(b);
    }
}

// With a ring of two arrays and one job, a call that draws nothing or is rejected counts as one of the later calls.
void RingWithAnEmptyCall()
{
    for (int refused = 0; refused < 2; refused++) {
        Setup s(0, 1);
        Wall a(10), b(10);
        s.pool->ClearBuffer();
        s.pool->RenderTriangles(a.vertices, QUAD, 2);
        s.pool->RenderTriangles(b.vertices, QUAD, refused == 0 ? 0 : -1);
        quad_at(a.vertices, -3, -3, 3, 3, 1); // maxJobs later calls have returned
        s.pool->Flush();
        CHECK(s.moc->TestRect(-0.1f, -0.1f, 0.1f, 0.1f, 5) == MOC::VISIBLE);
        CHECK(s.moc->TestRect(-0.1f, -0.1f, 0.1f, 0.1f, 20) == MOC::OCCLUDED);
    }
}

// A ring of maxJobs + 1 arrays needs no Flush, whatever the size of the calls.
void Ring()
{
    int wrong = 0;
    for (unsigned int jobs : {1u, 2u, 5u, 32u}) {
        for (unsigned int threads : {0u, 2u}) {
            Setup s(threads, jobs);
            MOC *one = Make();
            const unsigned int slots = jobs + 1;
            // A small mesh, or one large enough to be split into parts.
            enum { MOST = 900 };
            std::vector<float> vertices(static_cast<size_t>(slots) * 16 * MOST);
            std::vector<unsigned int> indices(static_cast<size_t>(slots) * 6 * MOST);
            uint32_t seed = jobs;
            for (int frame = 0; frame < 6; frame++) {
                if (frame % 3 != 2)
                    s.pool->WakeThreads();
                else
                    s.pool->SuspendThreads();
                s.pool->ClearBuffer();
                one->ClearBuffer();
                for (unsigned int k = 0; k < 150; k++) {
                    float *v = &vertices[static_cast<size_t>(k % slots) * 16 * MOST];
                    unsigned int *t = &indices[static_cast<size_t>(k % slots) * 6 * MOST];
                    // A mesh may be culled entirely, or rejected: it still counts among the maxJobs.
                    if (k % 11 == 3 || k % 11 == 4) {
                        quad_at(v, -1, -1, 1, 1, 0.5f);
                        s.pool->RenderTriangles(v, t, k % 11 == 3 ? 0 : -1);
                        continue;
                    }
                    const int quads = k % 37 == 5 ? MOST : 1 + static_cast<int>(next_random(&seed) % 3);
                    for (int q = 0; q < quads; q++) {
                        const float x = next_unit(&seed), y = next_unit(&seed), w = 50 + 49 * next_unit(&seed);
                        quad_at(v + 16 * q, x - 0.05f, y - 0.05f, x + 0.05f, y + 0.05f, w);
                        for (int i = 0; i < 6; i++)
                            t[6 * q + i] = static_cast<unsigned int>(4 * q) + QUAD[i];
                    }
                    s.pool->RenderTriangles(v, t, 2 * quads);
                    one->RenderTriangles(v, t, 2 * quads);
                }
                s.pool->Flush();
                wrong += Depth(s.moc) != Depth(one);
            }
            MOC::Destroy(one);
        }
    }
    CHECK_EQ(wrong, 0);
}

// Work submitted while threads are awake is drawn without another call, however little it is; SuspendThreads draws the
// rest.
void WithoutFlush()
{
    Setup s;
    MOC *other = Make();
    other->RenderTriangles(WALL.vertices, QUAD, 2, nullptr, MOC::BACKFACE_NONE);
    int late = 0, parked = 0;
    for (int k = 0; k < 40; k++) {
        s.pool->WakeThreads();
        s.pool->ClearBuffer();
        // The threads may or may not be asleep when the calls come.
        if (k % 4 == 0)
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        if (k % 8 == 7) {
            s.pool->MergeBuffers(&other, 1);
        } else {
            for (int call = 0; call < 1 + k % 11; call++)
                s.Draw();
        }
        late += !Soon([&] { return s.pool->IsDone(); });
        late += !Hidden(s.moc);
        s.pool->ClearBuffer();
        for (int call = 0; call < 10; call++)
            s.Draw();
        s.pool->SuspendThreads();
        CHECK(s.pool->IsDone());
        parked += !Hidden(s.moc);
        s.pool->ClearBuffer();
        s.Draw(); // waits for WakeThreads
        CHECK(!s.pool->IsDone());
        s.pool->WakeThreads();
        late += !Soon([&] { return s.pool->IsDone(); });
    }
    CHECK_EQ(late, 0);
    CHECK_EQ(parked, 0);
    // Work left behind by a caller that helped because there was no room.
    Setup narrow(1, 1);
    narrow.pool->WakeThreads();
    for (int k = 0; k < 50; k++) {
        for (int call = 0; call < 5; call++)
            narrow.Draw();
        CHECK(Soon([&] { return narrow.pool->IsDone(); }));
    }
    MOC::Destroy(other);
}

// An object keeps its near plane when it is set as a pool's buffer.
void NearPlane()
{
    MOC *a = Make(), *b = Make();
    Pool pool(2, 2, 2);
    pool.SetNearClipPlane(3); // no object: nothing to set
    pool.SetBuffer(a);
    CHECK(a->GetNearClipPlane() == 0.1f);
    pool.SetNearClipPlane(1);
    CHECK(a->GetNearClipPlane() == 1.0f);
    pool.SetBuffer(b);
    pool.Flush();
    CHECK(b->GetNearClipPlane() == 0.1f);
    float triangle[16];
    quad_at(triangle, -0.4f, -0.4f, 0.4f, 0.4f, 0.5f);
    CHECK(b->TestTriangles(triangle, QUAD, 1, nullptr, MOC::BACKFACE_NONE) == MOC::VISIBLE);
    CHECK(pool.TestTriangles(triangle, QUAD, 1, nullptr, MOC::BACKFACE_NONE) == MOC::VISIBLE);
    pool.SetBuffer(nullptr);
    MOC::Destroy(a);
    MOC::Destroy(b);
}

// Other threads query the object itself while its pool draws and clears. Everything drawn is in the left half, between
// 5 and 15 away.
void QueriesAtTheObject()
{
    std::vector<Wall> walls;
    uint32_t seed = 3;
    for (int i = 0; i < 40; i++) {
        walls.emplace_back(1.0f);
        const float y = next_unit(&seed), w = 10.0f + 5.0f * next_unit(&seed);
        quad_at(walls.back().vertices, -1.5f, y - 0.5f, -0.05f, y + 0.5f, w);
    }
    Setup s;
    s.pool->WakeThreads();
    std::atomic<bool> done(false);
    std::atomic<int> lies(0), asked(0), hidden(0);
    std::vector<std::thread> asking;
    for (uint32_t number = 0; number < 2; number++)
        asking.emplace_back([&, number] {
            uint32_t state = number;
            const MOC *moc = s.moc;
            while (!done) {
                const float x = 0.4f * (next_unit(&state) + 1.0f), y = 0.9f * next_unit(&state);
                float right[16], far[16];
                quad_at(right, x + 0.01f, y - 0.1f, x + 0.1f, y + 0.1f, 50);
                quad_at(far, -x - 0.1f, y - 0.1f, -x - 0.05f, y + 0.1f, 50);
                lies += moc->TestRect(-0.05f - x, y - 0.1f, 0, y + 0.1f, 4) != MOC::VISIBLE;
                lies += moc->TestRect(x + 0.01f, y - 0.1f, x + 0.1f, y + 0.1f, 50) != MOC::VISIBLE;
                lies += moc->TestRect(1.5f, y - 0.1f, 1.7f, y + 0.1f, 50) != MOC::VIEW_CULLED;
                lies += moc->TestTriangles(right, QUAD, 2) != MOC::VISIBLE;
                lies += moc->TestTriangles(far, QUAD, 2) == MOC::VIEW_CULLED;
                hidden += moc->TestRect(-x - 0.1f, y - 0.1f, -x - 0.05f, y + 0.1f, 50) == MOC::OCCLUDED;
                asked++;
            }
        });
    for (int frame = 0; frame < 100 || asked < 400; frame++) {
        s.pool->ClearBuffer();
        for (const Wall &wall : walls)
            s.Draw(wall);
        if (frame % 3 == 0)
            s.pool->Flush();
    }
    done = true;
    for (std::thread &thread : asking)
        thread.join();
    CHECK_EQ(lies.load(), 0);
    CHECK(hidden > 0);
}

// While work is in flight, calls that would change or copy the object's buffer are rejected in C and wait in C++.
void DirectUseOfABusyObject()
{
    Setup s(0); // without worker threads nothing is drawn until a call does the work
    MOC *one = Make(), *other = Make();
    const Wall near(3, 0.5f);
    const auto submit = [&] { s.Draw(); };
    std::vector<float> pixels(640 * 480);
    int32_t result = 7;
    submit();
    MOC_TriList list = {};
    const int32_t none = MOC_BACKFACE_NONE, all = MOC_CLIP_PLANE_ALL;
    CHECK_EQ(MOC_RenderTriangles(s.moc, near.vertices, QUAD, 2, nullptr, none, all, nullptr, &result), MOC_STATUS_BUSY);
    CHECK_EQ(result, MOC_VISIBLE);
    CHECK_EQ(MOC_ClearBuffer(s.moc), MOC_STATUS_BUSY);
    CHECK_EQ(MOC_SetResolution(s.moc, 100, 100), MOC_STATUS_BUSY);
    CHECK_EQ(MOC_MergeBuffer(s.moc, other), MOC_STATUS_BUSY);
    CHECK_EQ(MOC_MergeBuffer(other, s.moc), MOC_STATUS_BUSY);
    CHECK_EQ(MOC_RenderTrilist(s.moc, &list, nullptr), MOC_STATUS_BUSY);
    CHECK_EQ(MOC_ComputePixelDepthBuffer(s.moc, pixels.data(), 0), MOC_STATUS_BUSY);
    CHECK(!s.pool->IsDone());
    CHECK_EQ(MOC_Flush(s.moc), MOC_STATUS_OK);
    CHECK(s.pool->IsDone());
    CHECK(Hidden(s.moc));
    CHECK_EQ(MOC_ClearBuffer(s.moc), MOC_STATUS_OK);
    CHECK_EQ(MOC_Flush(other), MOC_STATUS_OK);
    CHECK_EQ(MOC_Flush(nullptr), MOC_STATUS_NULL_POINTER);

    // The same pixels as with one thread, whether calls go through the pool or directly to the object.
    const auto direct = [&](MOC *moc) { moc->RenderTriangles(near.vertices, QUAD, 2, nullptr, MOC::BACKFACE_NONE); };
    submit();
    direct(s.moc);
    one->RenderTriangles(WALL.vertices, QUAD, 2);
    direct(one);
    submit();
    CHECK(Depth(s.moc) == Depth(one));
    submit();
    other->MergeBuffer(s.moc);
    CHECK(Hidden(other));
    submit();
    s.moc->MergeBuffer(other);
    submit();
    s.moc->ClearBuffer();
    CHECK(!Hidden(s.moc));
    submit();
    s.moc->SetResolution(320, 240);
    CHECK(!Hidden(s.moc));
    submit();
    s.pool->Flush();
    CHECK(Hidden(s.moc));

    // One pool at a time.
    Pool second(1, 2, 2);
    second.SetBuffer(s.moc);
    second.ClearBuffer();
    second.Flush();
    CHECK(Hidden(s.moc));
    s.pool->SetBuffer(s.moc); // the same object again
    s.pool->SetBuffer(nullptr);
    second.SetBuffer(s.moc);
    second.ClearBuffer();
    CHECK(!Hidden(s.moc));
    second.SetBuffer(nullptr);
    s.pool->SetBuffer(s.moc);
    MOC::Destroy(one);
    MOC::Destroy(other);
}

} // namespace

int main()
{
    deadline(300);
    ClearThenQuery();
    ClearThenDraw();
    FlushThenFree();
    DestroyInAnyOrder();
    Ring();
    RingWithAnEmptyCall();
    WithoutFlush();
    NearPlane();
    QueriesAtTheObject();
    DirectUseOfABusyObject();
    return check_report("pool_contract");
}
