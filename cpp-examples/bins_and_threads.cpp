// Drawing with several threads: one pass sorts triangles into bins of the screen, then each thread draws its own bins.
// The buffer is the same, to the bit, as when one thread draws everything.
#include "MaskedOcclusionCulling.h"

#include <atomic>
#include <cstdio>
#include <cstring>
#include <random>
#include <thread>
#include <vector>

typedef MaskedOcclusionCulling Moc;

static const unsigned kWidth = 1280, kHeight = 720, kBinsW = 4, kBinsH = 2, kBins = kBinsW * kBinsH;

static void DrawBinned(Moc *moc, const std::vector<float> &vertices, const std::vector<unsigned> &indices) {
    const unsigned numTriangles = unsigned(indices.size() / 3);

    // Room for every triangle in every bin, 9 floats each. Clipping can turn one triangle into two or three, so a real
    // engine leaves a margin; a full list takes no more triangles, which hides less but never wrongly.
    const unsigned capacity = numTriangles * 2;
    std::vector<float> memory(size_t(kBins) * capacity * 9);
    Moc::TriList lists[kBins];
    for (unsigned i = 0; i < kBins; ++i) {
        lists[i].mNumTriangles = capacity;
        lists[i].mTriIdx = 0;
        lists[i].mPtr = &memory[size_t(i) * capacity * 9];
    }
    moc->BinTriangles(vertices.data(), indices.data(), int(numTriangles), lists, kBinsW, kBinsH);

    // Bin sizes are multiples of 32x8 pixels; the last column and row take the rest.
    unsigned binWidth, binHeight;
    moc->ComputeBinWidthHeight(kBinsW, kBinsH, binWidth, binHeight);

    std::atomic<unsigned> next(0);
    const auto work = [&] {
        for (unsigned i = next++; i < kBins; i = next++) {
            const unsigned column = i % kBinsW, row = i / kBinsW;
            const Moc::ScissorRect bin(
                int(column * binWidth), int(row * binHeight),
                int(column + 1 == kBinsW ? kWidth : (column + 1) * binWidth),
                int(row + 1 == kBinsH ? kHeight : (row + 1) * binHeight));
            moc->RenderTrilist(lists[i], &bin);
        }
    };
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) threads.emplace_back(work);
    for (std::thread &thread : threads) thread.join();
}

static Moc *NewBuffer() {
    Moc *moc = Moc::Create();
    moc->SetResolution(kWidth, kHeight);
    moc->SetNearClipPlane(0.1f);
    moc->ClearBuffer();
    return moc;
}

int main() {
    // Triangles scattered in front of the eye, some off screen and some across the near plane.
    std::mt19937 random(1);
    const auto uniform = [&](float lo, float hi) { return lo + (hi - lo) * float(random() % 65536) / 65535.0f; };
    std::vector<float> vertices;
    std::vector<unsigned> indices;
    for (unsigned i = 0; i < 3 * 5000; ++i) {
        const float w = uniform(-1, 40);
        const float vertex[] = {uniform(-40, 40), uniform(-40, 40), 0, w};
        vertices.insert(vertices.end(), vertex, vertex + 4);
        indices.push_back(i);
    }

    Moc *alone = NewBuffer(), *together = NewBuffer();
    alone->RenderTriangles(vertices.data(), indices.data(), int(indices.size() / 3));
    DrawBinned(together, vertices, indices);

    std::vector<float> a(kWidth * kHeight), b(kWidth * kHeight);
    alone->ComputePixelDepthBuffer(a.data(), false);
    together->ComputePixelDepthBuffer(b.data(), false);
    const bool same = std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
    size_t covered = 0;
    for (float depth : a) covered += depth > 0;
    std::printf("%zu triangles, %.1f%% of the screen covered, one thread and four agree: %s\n", indices.size() / 3,
                100.0 * double(covered) / double(a.size()), same ? "yes" : "no");
    Moc::Destroy(alone);
    Moc::Destroy(together);
    return same ? 0 : 1;
}
