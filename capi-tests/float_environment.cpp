// Threads whose floating-point environment an engine has changed: other rounding modes, denormals flushed, exceptions
// that raise a signal. Draws, tests, merges and pools give the same bits as in the default environment, no signal is
// raised, and the environment is preserved.
#include "check.h"

#include "CullingThreadpool.h"

#include <fenv.h>
#if defined(__SSE__) || defined(_M_X64)
#include <xmmintrin.h>
#define HAS_MXCSR 1
#else
#define HAS_MXCSR 0
#endif

#include <vector>

namespace
{

typedef MaskedOcclusionCulling MOC;

const int WIDTH = 640, HEIGHT = 360, COUNT = 2000;

struct Result
{
    std::vector<float> depth, merged, pooled, transformed;
    std::vector<int> answers;

    bool operator==(const Result &other) const
    {
        return Same(depth, other.depth) && Same(merged, other.merged) && Same(pooled, other.pooled) &&
               Same(transformed, other.transformed) && answers == other.answers;
    }

    static bool Same(const std::vector<float> &a, const std::vector<float> &b)
    {
        return a.size() == b.size() && memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
    }
};

std::vector<float> vertices;
std::vector<unsigned int> indices;

void Make()
{
    vertices.resize(12 * COUNT);
    indices.resize(3 * COUNT);
    random_triangles(vertices.data(), indices.data(), COUNT, 7);
    // Denormal coordinates, and triangles through the near plane.
    for (int i = 0; i < COUNT; i += 9) {
        vertices[12 * i] = 1e-40f;
        vertices[12 * i + 4] *= 1e-39f;
        vertices[12 * i + 11] = -1.0f;
    }
}

Result Run(MOC::Implementation implementation)
{
    Result r;
    MOC *moc = MOC::Create(implementation), *other = MOC::Create(implementation), *pooled = MOC::Create(implementation);
    for (MOC *m : {moc, other, pooled}) {
        m->SetResolution(WIDTH, HEIGHT);
        m->SetNearClipPlane(0.1f);
    }
    moc->RenderTriangles(vertices.data(), indices.data(), COUNT / 2);
    other->RenderTriangles(vertices.data(), indices.data() + 3 * (COUNT / 2), COUNT / 2);
    for (int i = 0; i < COUNT; ++i) {
        r.answers.push_back(moc->TestTriangles(vertices.data(), &indices[3 * i], 1, nullptr, MOC::BACKFACE_NONE));
        const float *v = &vertices[12 * i];
        r.answers.push_back(moc->TestRect(v[0] * 0.1f, v[1] * 0.1f, v[0] * 0.1f + 0.02f, v[1] * 0.1f + 0.02f, v[3]));
    }
    r.depth.resize(WIDTH * HEIGHT);
    moc->ComputePixelDepthBuffer(r.depth.data(), false);
    moc->MergeBuffer(other);
    r.merged.resize(WIDTH * HEIGHT);
    moc->ComputePixelDepthBuffer(r.merged.data(), false);
    {
        CullingThreadpool pool(2, 2, 2, 32, 3);
        pool.SetBuffer(pooled);
        pool.WakeThreads();
        pool.RenderTriangles(vertices.data(), indices.data(), COUNT);
        r.pooled.resize(WIDTH * HEIGHT);
        pool.ComputePixelDepthBuffer(r.pooled.data(), false);
    }
    const float matrix[16] = {0.3f, 0.1f, 0, 0.7f, 0.2f, 0.9f, 0, 0.1f, 0.4f, 0.3f, 1, 0.6f, 0.1f, 1e-39f, 0, 0.3f};
    r.transformed.resize(4 * 3 * COUNT);
    MOC::TransformVertices(matrix, vertices.data(), r.transformed.data(), 3 * COUNT, MOC::VertexLayout(16, 4, 8));
    for (MOC *m : {moc, other, pooled})
        MOC::Destroy(m);
    return r;
}

} // namespace

int main()
{
    Make();
    for (MOC::Implementation implementation : {MOC::SCALAR, MOC::SSE2, MOC::SSE41, MOC::AVX2, MOC::AVX512}) {
        const Result expected = Run(implementation);
        for (int rounding : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
            CHECK(fesetround(rounding) == 0);
            const Result result = Run(implementation);
            CHECK_EQ(fegetround(), rounding);
            fesetround(FE_TONEAREST);
            // This program itself rounded TestRect's arguments differently, so only those answers may differ.
            Result same = result;
            for (size_t i = 1; i < same.answers.size(); i += 2)
                same.answers[i] = expected.answers[i];
            CHECK(same == expected);
        }
#if HAS_MXCSR
        // Flush-to-zero and denormals-are-zero; traps for invalid operation, division by zero and overflow.
        for (unsigned int control : {0x8000u | 0x0040u | 0x1f80u, 0x1f80u & ~(0x0080u | 0x0200u | 0x0400u)}) {
            _mm_setcsr(control);
            const Result result = Run(implementation);
            const unsigned int after = _mm_getcsr();
            _mm_setcsr(0x1f80);
            CHECK_EQ(after & ~0x3fu, control);
            CHECK(result == expected);
        }
#endif
    }
    return check_report("float_environment");
}
