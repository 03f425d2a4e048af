// Several threads bin, draw and query one object concurrently: the same bits and answers as with one thread.
#include "check.h"

#include "MaskedOcclusionCulling.h"

#include <atomic>
#include <thread>
#include <vector>

namespace
{

typedef MaskedOcclusionCulling MOC;

enum { W = 1000, H = 500, BINS_W = 7, BINS_H = 5, BINS = BINS_W * BINS_H, THREADS = 4, CHUNKS = 8, PER_CHUNK = 400 };

struct Scene
{
    std::vector<float> vertices;
    std::vector<unsigned int> indices;
    Scene() : vertices(12 * CHUNKS * PER_CHUNK), indices(3 * CHUNKS * PER_CHUNK)
    {
        random_triangles(vertices.data(), indices.data(), CHUNKS * PER_CHUNK, 4711);
    }
};

template <class Work> void OnThreads(Work work)
{
    std::vector<std::thread> threads;
    for (int i = 0; i < THREADS; i++)
        threads.emplace_back(work);
    for (std::thread &thread : threads)
        thread.join();
}

std::vector<float> Depth(const MOC *moc)
{
    std::vector<float> depth(W * H);
    moc->ComputePixelDepthBuffer(depth.data(), false);
    return depth;
}

void DrawBinned(MOC *moc, const Scene &scene)
{
    // Room for more, because clipping may turn a triangle into a few.
    const unsigned int room = 4 * PER_CHUNK;
    std::vector<float> storage(static_cast<size_t>(CHUNKS) * BINS * room * 9);
    std::vector<MOC::TriList> lists(CHUNKS * BINS);
    for (size_t i = 0; i < lists.size(); i++) {
        lists[i].mNumTriangles = room;
        lists[i].mTriIdx = 0;
        lists[i].mPtr = &storage[i * room * 9];
    }
    std::atomic<int> next_chunk(0), next_bin(0);
    OnThreads([&] {
        for (int chunk; (chunk = next_chunk++) < CHUNKS;)
            moc->BinTriangles(scene.vertices.data(), &scene.indices[3 * PER_CHUNK * chunk], PER_CHUNK,
                              &lists[chunk * BINS], BINS_W, BINS_H, nullptr, MOC::BACKFACE_NONE);
    });
    unsigned int width = 0, height = 0;
    moc->ComputeBinWidthHeight(BINS_W, BINS_H, width, height);
    CHECK(width == 128 && height == 96);
    OnThreads([&] {
        for (int bin; (bin = next_bin++) < BINS;) {
            const int x = bin % BINS_W, y = bin / BINS_W;
            const int w = static_cast<int>(width), h = static_cast<int>(height);
            const MOC::ScissorRect rect(x * w, y * h, x == BINS_W - 1 ? int(W) : (x + 1) * w,
                                        y == BINS_H - 1 ? int(H) : (y + 1) * h);
            for (int chunk = 0; chunk < CHUNKS; chunk++)
                moc->RenderTrilist(lists[chunk * BINS + bin], &rect);
        }
    });
}

void Run(int32_t implementation, int32_t rule, const Scene &scene)
{
    MOC_Settings settings = {};
    settings.size = sizeof(settings);
    MOC_DefaultSettings(&settings);
    settings.implementation = implementation;
    settings.update_rule = rule;
    MOC *one = nullptr, *many = nullptr;
    settings.statistics = 1;
    CHECK_EQ(MOC_Create(&settings, &one), MOC_STATUS_OK);
    CHECK_EQ(MOC_Create(&settings, &many), MOC_STATUS_OK);
    one->SetResolution(W, H);
    many->SetResolution(W, H);
    one->RenderTriangles(scene.vertices.data(), scene.indices.data(), CHUNKS * PER_CHUNK, nullptr, MOC::BACKFACE_NONE);
    DrawBinned(many, scene);
    const std::vector<float> expected = Depth(one);
    int covered = 0;
    for (float d : expected)
        covered += d >= 0.0f;
    CHECK(covered > W * H / 2);
    CHECK(Depth(many) == expected);

    // Queries from all threads concurrently, compared with one thread's answers.
    enum { QUERIES = 2000 };
    std::vector<int> answers(QUERIES), again(QUERIES);
    const auto ask = [&](const MOC *moc, int i) {
        uint32_t state = static_cast<uint32_t>(i) * 2654435761u;
        const float x = next_unit(&state), y = next_unit(&state), w = 6.0f + 5.0f * next_unit(&state);
        if (i % 2 == 0)
            return static_cast<int>(moc->TestRect(x, y, x + 0.05f, y + 0.05f, w));
        float quad[16];
        quad_at(quad, x, y, x + 0.05f, y + 0.05f, w);
        return static_cast<int>(moc->TestTriangles(quad, QUAD, 2));
    };
    int hidden = 0;
    for (int i = 0; i < QUERIES; i++)
        hidden += (answers[i] = ask(one, i)) == MOC::OCCLUDED;
    CHECK(hidden > 0 && hidden < QUERIES);
    std::atomic<int> next_query(0);
    OnThreads([&] {
        for (int i; (i = next_query++) < QUERIES;)
            again[i] = ask(many, i);
    });
    CHECK(answers == again);
    CHECK(many->GetStatistics().mOccludees.mNumProcessedRectangles == QUERIES / 2);
    CHECK(many->GetStatistics().mOccludees.mNumProcessedTriangles == QUERIES);
    MOC::Destroy(one);
    MOC::Destroy(many);
}

} // namespace

int main()
{
    const Scene scene;
    const int32_t implementations[] = {MOC_SCALAR, MOC_SSE2, MOC_SSE41, MOC_AVX2, MOC_AVX512};
    for (int32_t implementation : implementations)
        for (int32_t rule = MOC_UPDATE_RULE_THREE_LAYER; rule <= MOC_UPDATE_RULE_FOUR_LAYER; rule++)
            Run(implementation, rule, scene);
    return check_report("threads");
}
