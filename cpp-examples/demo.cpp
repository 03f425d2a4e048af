// Occlusion culling of one frame, as an engine does it: which objects of a scene need not be drawn?
//
//     demo SCENE RESULT [highest instruction set: a number of MaskedOcclusionCulling::Implementation]
//
// `cargo run --release -p demo` creates the scene, compiles and runs this program, and draws its results.
#include "MaskedOcclusionCulling.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

typedef MaskedOcclusionCulling Moc;

// The scene file, little-endian: the header, then vertices (x, y, z as floats), indices (three per triangle, counted
// from the object's first vertex) and objects.
struct Header {
    char magic[8];  // "MOCDEMO1"
    uint32_t width, height, numVertices, numIndices, numObjects;
    float nearPlane;
    float clipFromWorld[16];  // column-major: x' = x*m[0] + y*m[4] + z*m[8] + m[12]
};
struct Object {
    uint32_t firstVertex, firstIndex, numTriangles, flags;
    float lo[3], hi[3];  // bounding box
};
enum ObjectFlags { OCCLUDER = 1, TWO_SIDED = 2 };

struct Scene {
    Header header;
    std::vector<float> vertices;
    std::vector<uint32_t> indices;
    std::vector<Object> objects;
};

// An object's bounding box on the screen.
struct ScreenBox {
    float xmin, ymin, xmax, ymax;  // normalised device coordinates
    float wmin;                    // w of the nearest corner
    bool outside;                  // outside the view
    bool crossesNear;              // extends in front of the near plane: it has no rectangle
};

static ScreenBox ProjectBox(const Object &object, const float *m, float nearPlane) {
    ScreenBox box = {INFINITY, INFINITY, -INFINITY, -INFINITY, INFINITY, false, false};
    int outsideOfAll = 0x1f;  // the planes that have every corner on their outer side
    for (int i = 0; i < 8; ++i) {
        const float x = i & 1 ? object.hi[0] : object.lo[0];
        const float y = i & 2 ? object.hi[1] : object.lo[1];
        const float z = i & 4 ? object.hi[2] : object.lo[2];
        const float cx = x * m[0] + y * m[4] + z * m[8] + m[12];
        const float cy = x * m[1] + y * m[5] + z * m[9] + m[13];
        const float cw = x * m[3] + y * m[7] + z * m[11] + m[15];
        outsideOfAll &= (cw < nearPlane) | (cx < -cw) << 1 | (cx > cw) << 2 | (cy < -cw) << 3 | (cy > cw) << 4;
        box.wmin = std::min(box.wmin, cw);
        box.xmin = std::min(box.xmin, cx / cw), box.xmax = std::max(box.xmax, cx / cw);
        box.ymin = std::min(box.ymin, cy / cw), box.ymax = std::max(box.ymax, cy / cw);
    }
    box.outside = outsideOfAll != 0;
    box.crossesNear = box.wmin <= nearPlane;
    return box;
}

struct Frame {
    std::vector<ScreenBox> boxes;
    std::vector<uint32_t> occluders;  // front to back
    std::vector<uint8_t> results;     // a CullingResult for each object
    std::vector<double> steps;        // milliseconds
    size_t occluderTriangles;
};

static const char *const kSteps[] = {"project boxes, cull to the view", "sort occluders", "clear the buffer",
                                     "render occluders", "test objects"};
static const size_t kNumSteps = sizeof kSteps / sizeof *kSteps;

static void CullFrame(const Scene &scene, Moc *moc, Frame &frame) {
    typedef std::chrono::steady_clock Clock;
    Clock::time_point last = Clock::now();
    frame.steps.clear();
    const auto stepDone = [&] {
        const Clock::time_point now = Clock::now();
        frame.steps.push_back(std::chrono::duration<double, std::milli>(now - last).count());
        last = now;
    };
    const std::vector<Object> &objects = scene.objects;

    frame.boxes.resize(objects.size());
    for (size_t i = 0; i < objects.size(); ++i)
        frame.boxes[i] = ProjectBox(objects[i], scene.header.clipFromWorld, scene.header.nearPlane);
    stepDone();

    // Front to back, hidden occluders are rejected early.
    frame.occluders.clear();
    for (uint32_t i = 0; i < objects.size(); ++i)
        if ((objects[i].flags & OCCLUDER) && !frame.boxes[i].outside) frame.occluders.push_back(i);
    std::sort(frame.occluders.begin(), frame.occluders.end(),
              [&](uint32_t a, uint32_t b) { return frame.boxes[a].wmin < frame.boxes[b].wmin; });
    stepDone();

    moc->ClearBuffer();
    stepDone();

    // World-space positions and a matrix: 12 bytes per vertex, with y at offset 4 and z at offset 8.
    const Moc::VertexLayout layout(12, 4, 8);
    frame.occluderTriangles = 0;
    for (uint32_t i : frame.occluders) {
        const Object &object = objects[i];
        moc->RenderTriangles(&scene.vertices[size_t(object.firstVertex) * 3], &scene.indices[object.firstIndex],
                             int(object.numTriangles), scene.header.clipFromWorld,
                             object.flags & TWO_SIDED ? Moc::BACKFACE_NONE : Moc::BACKFACE_CW, Moc::CLIP_PLANE_ALL,
                             layout);
        frame.occluderTriangles += object.numTriangles;
    }
    stepDone();

    frame.results.resize(objects.size());
    for (size_t i = 0; i < objects.size(); ++i) {
        const ScreenBox &box = frame.boxes[i];
        frame.results[i] = uint8_t(box.outside       ? Moc::VIEW_CULLED
                                   : box.crossesNear ? Moc::VISIBLE
                                                     : moc->TestRect(box.xmin, box.ymin, box.xmax, box.ymax, box.wmin));
    }
    stepDone();
}

static void Fail(const char *what, const char *path) {
    std::fprintf(stderr, "demo: %s %s\n", what, path);
    std::exit(1);
}

template <class T> static void Read(std::FILE *file, const char *path, T *to, size_t count) {
    if (std::fread(to, sizeof(T), count, file) != count) Fail("the scene file is cut short:", path);
}

static Scene LoadScene(const char *path) {
    std::FILE *file = std::fopen(path, "rb");
    if (!file) Fail("cannot open", path);
    Scene scene;
    Read(file, path, &scene.header, 1);
    if (std::memcmp(scene.header.magic, "MOCDEMO1", 8) != 0) Fail("not a scene file:", path);
    scene.vertices.resize(size_t(scene.header.numVertices) * 3);
    scene.indices.resize(scene.header.numIndices);
    scene.objects.resize(scene.header.numObjects);
    Read(file, path, scene.vertices.data(), scene.vertices.size());
    Read(file, path, scene.indices.data(), scene.indices.size());
    Read(file, path, scene.objects.data(), scene.objects.size());
    std::fclose(file);
    return scene;
}

// A CullingResult for each object, one byte each; then the depth (1/w) of each pixel, top row first, as floats.
static void SaveResult(const char *path, const std::vector<uint8_t> &results, const std::vector<float> &depth) {
    std::FILE *file = std::fopen(path, "wb");
    if (!file || std::fwrite(results.data(), 1, results.size(), file) != results.size() ||
        std::fwrite(depth.data(), sizeof(float), depth.size(), file) != depth.size() || std::fclose(file) != 0)
        Fail("cannot write", path);
}

static const char *Name(int implementation) {
    switch (implementation) {
        case Moc::SSE2: return "SSE2";
        case Moc::SSE41: return "SSE4.1";
        case Moc::AVX2: return "AVX2";
        case Moc::AVX512: return "AVX-512";
        case Moc::NEON: return "NEON";
        case Moc::SIMD128: return "simd128";
        default: return "no vector instructions";
    }
}

static double Median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
}

int main(int argc, char **argv) {
    if (argc < 3) {
        std::fprintf(stderr, "usage: demo SCENE RESULT [highest instruction set, or - [recording]]\n");
        return 2;
    }
    const Scene scene = LoadScene(argv[1]);
    const unsigned width = scene.header.width, height = scene.header.height;

    const bool capped = argc > 3 && std::strcmp(argv[3], "-") != 0;
    Moc *moc = capped ? Moc::Create(Moc::Implementation(std::atoi(argv[3]))) : Moc::Create();
    moc->SetResolution(width, height);
    moc->SetNearClipPlane(scene.header.nearPlane);

    // Fewer repeats if a frame takes long.
    const std::chrono::steady_clock::time_point end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    Frame frame;
    std::vector<double> times[kNumSteps];
    size_t repeats = 0;
    for (; repeats < 31 && (repeats < 5 || std::chrono::steady_clock::now() < end); ++repeats) {
        CullFrame(scene, moc, frame);
        for (size_t s = 0; s < kNumSteps; ++s) times[s].push_back(frame.steps[s]);
    }

    const auto count = [&](int result) { return std::count(frame.results.begin(), frame.results.end(), result); };
    const long long total = (long long)frame.results.size(), outside = count(Moc::VIEW_CULLED);
    const long long culled = count(Moc::OCCLUDED), visible = count(Moc::VISIBLE), inView = total - outside;
    std::printf("\n%-34s %10lld\n", "objects", total);
    std::printf("  %-32s %10lld\n", "outside the view", outside);
    std::printf("  %-32s %10lld   %.1f%% of those in view\n", "culled", culled, inView ? 100.0 * culled / inView : 0.0);
    std::printf("  %-32s %10lld\n", "visible", visible);
    std::printf("occluders drawn, front to back     %10zu   %zu triangles\n\n", frame.occluders.size(),
                frame.occluderTriangles);
    std::printf("%-34s %10s   (%s, %ux%u, median of %zu)\n", "step", "ms", Name(moc->GetImplementation()), width, height,
                repeats);
    double sum = 0;
    for (size_t s = 0; s < kNumSteps; ++s) {
        std::printf("  %-32s %10.3f\n", kSteps[s], Median(times[s]));
        sum += Median(times[s]);
    }
    std::printf("  %-32s %10.3f\n\n", "all", sum);

    // One more frame, with all its calls and answers recorded to a file.
    if (argc > 4) {
        if (!moc->RecorderStart(argv[4])) Fail("cannot record into", argv[4]);
        CullFrame(scene, moc, frame);
        moc->RecorderStop();
    }

    std::vector<float> depth(size_t(width) * height);
    moc->ComputePixelDepthBuffer(depth.data(), false);
    SaveResult(argv[2], frame.results, depth);
    Moc::Destroy(moc);
}
