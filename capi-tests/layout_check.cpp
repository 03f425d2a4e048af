// Without NDEBUG, a matrix with the layout of clip-space vertices fails an assertion in each method that takes both.
#undef NDEBUG
#include "check.h"

#include "CullingThreadpool.h"

#include <setjmp.h>
#include <signal.h>

namespace
{

typedef MaskedOcclusionCulling MOC;

// x' = x, y' = y, w' = z + 10
const float MATRIX[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 10};
const float VERTICES[16] = {-9, -9, 1, 1, 9, -9, 1, 1, 9, 9, 1, 1, -9, 9, 1, 1};

jmp_buf before;

void Aborted(int) { longjmp(before, 1); }

// Whether an assertion stops the call. Whether the signal stays blocked depends on the handler, so it is installed each
// time.
template <class Call> bool Asserts(Call call)
{
    if (setjmp(before) != 0)
        return true;
    signal(SIGABRT, Aborted);
    call();
    signal(SIGABRT, SIG_DFL);
    return false;
}

} // namespace

int main(int argc, char **argv)
{
    MOC *moc = MOC::Create();
    moc->SetResolution(64, 64);
    float data[9 * 4];
    MOC::TriList list = {4, 0, data};
    CullingThreadpool pool(0, 1, 1);
    pool.SetBuffer(moc);
    // One call per run: abort() may hold its lock forever if a handler does not return.
    const int which = argc > 1 ? atoi(argv[1]) : -1;
    const MOC::VertexLayout right(16, 4, 8);
    const MOC::BackfaceWinding winding = MOC::BACKFACE_CW;
    const MOC::ClipPlanes planes = MOC::CLIP_PLANE_ALL;
    switch (which) {
    case 0: CHECK(Asserts([=] { moc->RenderTriangles(VERTICES, QUAD, 2, MATRIX); })); break;
    case 1: CHECK(Asserts([=] { moc->TestTriangles(VERTICES, QUAD, 2, MATRIX); })); break;
    case 2: CHECK(Asserts([&] { moc->BinTriangles(VERTICES, QUAD, 2, &list, 1, 1, MATRIX); })); break;
    case 3: CHECK(Asserts([=] { moc->RecordRenderTriangles(VERTICES, QUAD, 2, MATRIX); })); break;
    case 4: CHECK(Asserts([&] { pool.RenderTriangles(VERTICES, QUAD, 2, MATRIX); })); break;
    case 5: CHECK(Asserts([&] { pool.TestTriangles(VERTICES, QUAD, 2, MATRIX); })); break;
    default:
        CHECK(!Asserts([&] {
            moc->RenderTriangles(VERTICES, QUAD, 2);
            moc->RenderTriangles(VERTICES, QUAD, 2, MATRIX, winding, planes, right);
            moc->TestTriangles(VERTICES, QUAD, 2, MATRIX, winding, planes, right);
            moc->BinTriangles(VERTICES, QUAD, 2, &list, 1, 1, MATRIX, winding, planes, right);
            pool.RenderTriangles(VERTICES, QUAD, 2, MATRIX, winding, planes, right);
            pool.Flush();
        }));
        MOC::Destroy(moc);
    }
    return check_report("layout_check");
}
