// A frame drawn by a thread pool: draw calls return at once, Flush waits until everything is drawn, and then boxes are
// tested. The buffer is the same, to the bit, as when one thread draws everything.
#include "CullingThreadpool.h"

#include <atomic>
#include <cstdio>
#include <thread>
#include <vector>

typedef MaskedOcclusionCulling Moc;

struct Position {
    float x, y, z;
};

// A box around the origin, one unit each way; counter-clockwise as seen from outside.
static const Position kCorners[8] = {
    {-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1},
};
static const unsigned kFaces[36] = {
    0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 3, 6, 2, 3, 7, 6, 0, 4, 7, 0, 7, 3, 1, 2, 6, 1, 6, 5,
};

struct Box {
    Position centre, half;
};

// The model-to-clip matrix of a box, for a camera at the origin looking along -z. Column-major for column vectors
// (OpenGL), which has the same memory layout as row-major for row vectors (Direct3D). The third row is not used.
static std::vector<float> ModelToClip(const Box &box) {
    const float focal = 1.5f, aspect = 16.0f / 9.0f;
    return {
        box.half.x * focal / aspect, 0, 0, 0,
        0, box.half.y * focal, 0, 0,
        0, 0, 0, -box.half.z,
        box.centre.x * focal / aspect, box.centre.y * focal, 0, -box.centre.z,
    };
}

int main() {
    Moc *moc = Moc::Create();
    moc->SetResolution(1280, 720);

    // Once: the threads, in addition to this one, and the parts of the screen that they share, several per thread. The
    // threads sleep until they are woken; an engine suspends them while it has nothing to cull.
    const unsigned processors = std::thread::hardware_concurrency();
    CullingThreadpool pool(processors > 1 ? processors - 1 : 1, 4, 4);
    pool.SetBuffer(moc);
    pool.SetNearClipPlane(0.1f);
    pool.WakeThreads();

    // Occluders: a street with a row of houses on each side, and a wall across its end.
    std::vector<Box> occluders;
    for (int i = 0; i < 20; ++i)
        for (float side : {-1.0f, 1.0f}) occluders.push_back({{side * 8, 0, -6.0f - 5 * i}, {4, 5, 2.4f}});
    occluders.push_back({{0, 0, -120}, {14, 6, 1}});

    size_t hidden = 0;
    bool behindWall = false, onStreet = false, behindHouses = false;
    for (int frame = 0; frame < 3; ++frame) {
        // A frame. Matrices are copied; vertices and indices must not change until Flush. With a matrix the third
        // offset of the layout is that of z.
        const Moc::VertexLayout layout(sizeof(Position), 4, 8);
        pool.ClearBuffer();
        for (const Box &box : occluders)
            pool.RenderTriangles(&kCorners[0].x, kFaces, 12, ModelToClip(box).data(), Moc::BACKFACE_CW,
                                 Moc::CLIP_PLANE_ALL, layout);

        // Here the engine does something else while the threads draw. Anything not drawn yet hides nothing, so a test
        // before Flush culls less, but never anything visible.
        pool.Flush();

        // Occludees, after the Flush. Any number of threads may test concurrently, each with its own matrices.
        const auto occluded = [&](const Box &box) {
            return pool.TestTriangles(&kCorners[0].x, kFaces, 12, ModelToClip(box).data(), Moc::BACKFACE_CW,
                                      Moc::CLIP_PLANE_ALL, layout) == Moc::OCCLUDED;
        };
        behindWall = occluded({{0, 0, -130}, {1, 1, 1}});
        onStreet = occluded({{0, 0, -60}, {1, 1, 1}});
        behindHouses = occluded({{-30, 0, -60}, {1, 1, 1}});
        hidden = 0;
        std::vector<std::thread> testers;
        std::atomic<size_t> found(0);
        for (int tester = 0; tester < 2; ++tester)
            testers.emplace_back([&, tester] {
                for (int i = tester; i < 1000; i += 2)
                    found += occluded({{-30 + 2.0f * (i % 31), -2, -10.0f - 0.15f * i}, {0.5f, 0.5f, 0.5f}});
            });
        for (std::thread &tester : testers) tester.join();
        hidden = found;
    }

    std::printf("behind the wall:      %s\n", behindWall ? "occluded" : "visible");
    std::printf("on the street:        %s\n", onStreet ? "occluded" : "visible");
    std::printf("behind the houses:    %s\n", behindHouses ? "occluded" : "visible");
    std::printf("of 1000 small boxes:  %zu occluded\n", hidden);

    // The object may be destroyed once no pool draws into it.
    pool.SetBuffer(nullptr);
    Moc::Destroy(moc);
    return behindWall && !onStreet && behindHouses ? 0 : 1;
}
