// A minimal engine built against the installed library: draws a wall and tests what it hides, directly and through a
// thread pool. The exit code says whether the answers are correct.
#include <CullingThreadpool.h>
#include <MaskedOcclusionCulling.h>

#include <cstdio>

static int failures = 0;

static void expect(const char *what, MaskedOcclusionCulling::CullingResult found, MaskedOcclusionCulling::CullingResult right) {
    std::printf("%s: %s\n", what, found == right ? "right" : "WRONG");
    failures += found != right;
}

int main() {
    // A wall over the left half of the screen, 5 away: x, y, z (not used), w.
    const float wall[] = {
        -5.0f, -5.0f, 0.0f, 5.0f,
        0.0f, -5.0f, 0.0f, 5.0f,
        0.0f, 5.0f, 0.0f, 5.0f,
        -5.0f, 5.0f, 0.0f, 5.0f,
    };
    const unsigned triangles[] = {0, 1, 2, 0, 2, 3};

    MaskedOcclusionCulling *moc = MaskedOcclusionCulling::Create();
    if (!moc) {
        return 2;
    }
    moc->SetResolution(640, 360);

    moc->ClearBuffer();
    moc->RenderTriangles(wall, triangles, 2);
    expect("C++, behind the wall", moc->TestRect(-0.7f, -0.2f, -0.3f, 0.2f, 8.0f), MaskedOcclusionCulling::OCCLUDED);
    expect("C++, beside the wall", moc->TestRect(0.3f, -0.2f, 0.7f, 0.2f, 8.0f), MaskedOcclusionCulling::VISIBLE);

    {
        CullingThreadpool pool(2, 2, 2);
        pool.SetBuffer(moc);
        pool.WakeThreads();
        pool.ClearBuffer();
        pool.RenderTriangles(wall, triangles, 2);
        pool.Flush();
        expect("pool, behind the wall", pool.TestRect(-0.7f, -0.2f, -0.3f, 0.2f, 8.0f), MaskedOcclusionCulling::OCCLUDED);
        expect("pool, beside the wall", pool.TestRect(0.3f, -0.2f, 0.7f, 0.2f, 8.0f), MaskedOcclusionCulling::VISIBLE);
    }

    MaskedOcclusionCulling::Destroy(moc);
    return failures ? 1 : 0;
}
