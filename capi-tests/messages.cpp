// Rejected calls are silent unless the program asks: there is the status of the thread's last call, and a callback that
// receives the function, the argument and the error.
#include "check.h"

// This test reports what the assertion would stop.
#define MOC_CHECK_LAYOUT 0
#include "CullingThreadpool.h"

#include <atomic>
#include <limits>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace
{

typedef MaskedOcclusionCulling MOC;

struct Told
{
    int status;
    std::string message;
    std::thread::id thread;
};

std::vector<Told> told;

void Listen(void *user, int status, const char *message)
{
    CHECK(user == &told);
    told.push_back(Told{status, message, std::this_thread::get_id()});
}

// Expects exactly one message, with this status and this beginning, and removes it; anything else is an error.
void Expect(int line, int status, const std::string &beginning)
{
    const bool one = told.size() == 1 && told[0].status == status && told[0].message.compare(0, beginning.size(), beginning) == 0;
    if (!one) {
        fprintf(stderr, "line %d: expected %d \"%s\", got %d messages\n", line, status, beginning.c_str(), int(told.size()));
        for (const Told &t : told)
            fprintf(stderr, "    %d \"%s\"\n", t.status, t.message.c_str());
    }
    CHECK(one);
    if (one)
        CHECK(told[0].thread == std::this_thread::get_id());
    told.clear();
}
#define EXPECT(status, beginning) Expect(__LINE__, status, beginning)

const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();

// Nothing is printed, thrown or reported before a callback is set; the status is still available.
void Silent()
{
    CHECK_EQ(MOC::GetLastStatus(), MOC_STATUS_OK);
    MOC *moc = MOC::Create();
    CHECK_EQ(moc->GetLastStatus(), MOC_STATUS_OK);
    moc->ClearBuffer();
    CHECK_EQ(moc->GetLastStatus(), MOC_STATUS_NO_BUFFER);
    moc->SetNearClipPlane(1);
    CHECK_EQ(moc->GetLastStatus(), MOC_STATUS_OK);
    CHECK(told.empty());
    MOC::Destroy(moc);
}

void WhatIsRefused()
{
    float quad[16];
    quad_at(quad, -1, -1, 1, 1, 10);
    MOC *moc = MOC::Create();
    unsigned int w, h;

    CHECK(moc->RenderTriangles(quad, QUAD, 2) == MOC::VISIBLE);
    EXPECT(MOC_STATUS_NO_BUFFER, "MOC_RenderTriangles: no buffer: call MOC_SetResolution first");
    CHECK(moc->TestTriangles(quad, QUAD, 2) == MOC::VISIBLE);
    EXPECT(MOC_STATUS_NO_BUFFER, "MOC_TestTriangles: no buffer: call MOC_SetResolution first");
    CHECK(moc->TestRect(-1, -1, 1, 1, 5) == MOC::VISIBLE);
    EXPECT(MOC_STATUS_NO_BUFFER, "MOC_TestRect: no buffer: call MOC_SetResolution first");
    moc->ClearBuffer();
    EXPECT(MOC_STATUS_NO_BUFFER, "MOC_ClearBuffer: no buffer: call MOC_SetResolution first");
    moc->GetResolution(w, h);
    EXPECT(MOC_STATUS_NO_BUFFER, "MOC_GetResolution: no buffer");
    moc->SetResolution(0, 100);
    EXPECT(MOC_STATUS_INVALID_SIZE, "MOC_SetResolution: width and height");
    CHECK_EQ(moc->GetLastStatus(), MOC_STATUS_INVALID_SIZE);

    moc->SetResolution(320, 200);
    CHECK(told.empty());
    CHECK_EQ(moc->GetLastStatus(), MOC_STATUS_OK);

    moc->SetNearClipPlane(nan);
    EXPECT(MOC_STATUS_INVALID_NUMBER, "MOC_SetNearClipPlane: the near plane");
    moc->RenderTriangles(nullptr, QUAD, 2);
    EXPECT(MOC_STATUS_NULL_POINTER, "MOC_RenderTriangles: vertices is null");
    moc->RenderTriangles(quad, nullptr, 2);
    EXPECT(MOC_STATUS_NULL_POINTER, "MOC_RenderTriangles: triangles is null");
    moc->RenderTriangles(quad, reinterpret_cast<const unsigned int *>(reinterpret_cast<const char *>(QUAD) + 1), 1);
    EXPECT(MOC_STATUS_INVALID_LAYOUT, "MOC_RenderTriangles: triangles is not aligned to 4");
    moc->RenderTriangles(quad, QUAD, -1);
    EXPECT(MOC_STATUS_INVALID_SIZE, "MOC_RenderTriangles: n_triangles");
    moc->RenderTriangles(quad, QUAD, 2, nullptr, static_cast<MOC::BackfaceWinding>(7));
    EXPECT(MOC_STATUS_INVALID_ENUM, "MOC_RenderTriangles: winding");
    moc->TestTriangles(quad, QUAD, 2, nullptr, MOC::BACKFACE_CW, static_cast<MOC::ClipPlanes>(0x40));
    EXPECT(MOC_STATUS_INVALID_ENUM, "MOC_TestTriangles: clip_planes");
    moc->TestTriangles(quad, QUAD, 2, nullptr, MOC::BACKFACE_CW, MOC::CLIP_PLANE_ALL, MOC::VertexLayout(-16, 4, 12));
    EXPECT(MOC_STATUS_INVALID_LAYOUT, "MOC_TestTriangles: the stride");
    moc->MergeBuffer(nullptr);
    EXPECT(MOC_STATUS_NULL_POINTER, "MOC_MergeBuffer: the other object is null");
    moc->ComputePixelDepthBuffer(nullptr, false);
    EXPECT(MOC_STATUS_NULL_POINTER, "MOC_ComputePixelDepthBuffer: the output pointer is null");

    float data[9 * 1];
    MOC::TriList list = {1, 0, data};
    moc->BinTriangles(quad, QUAD, 2, &list, 1, 1);
    EXPECT(MOC_STATUS_LIST_FULL, "MOC_BinTriangles: a triangle list is full");
    moc->BinTriangles(quad, QUAD, 2, &list, 0, 1);
    EXPECT(MOC_STATUS_INVALID_SIZE, "MOC_BinTriangles: bins_w or bins_h");
    const MOC::ScissorRect odd(1, 0, 32, 64);
    moc->RenderTrilist(list, &odd);
    EXPECT(MOC_STATUS_INVALID_SIZE, "MOC_RenderTrilist: the scissor rectangle");
    list.mTriIdx = 2;
    moc->RenderTrilist(list, nullptr);
    EXPECT(MOC_STATUS_INVALID_SIZE, "MOC_RenderTrilist: the list has a count above");
    CHECK(!moc->RecorderStart(nullptr));
    EXPECT(MOC_STATUS_NULL_POINTER, "MOC_RecorderStart: path is null");
    CHECK(MOC::Create(static_cast<MOC::Implementation>(99)) == nullptr);
    EXPECT(MOC_STATUS_INVALID_ENUM, "MOC_Create: implementation");
    MOC::TransformVertices(nullptr, quad, quad, 1);
    EXPECT(MOC_STATUS_NULL_POINTER, "MOC_TransformVertices: matrix is null");

    CHECK_EQ(MOC_RenderTrianglesChecked(moc, quad, 8, QUAD, 2, nullptr, 1, 0x1f, nullptr, nullptr),
             MOC_STATUS_INDEX_OUT_OF_RANGE);
    EXPECT(MOC_STATUS_INDEX_OUT_OF_RANGE, "MOC_RenderTrianglesChecked: triangles has an index");
    MOC::Destroy(moc);
}

// Rectangles that are probably a mistake are accepted, but reported.
void OddRectangles()
{
    MOC *moc = MOC::Create();
    moc->SetResolution(320, 200);
    CHECK(moc->TestRect(0.5f, -0.5f, -0.5f, 0.5f, 5) == MOC::VISIBLE);
    EXPECT(MOC_STATUS_OK, "MOC_TestRect: xmin is above xmax");
    CHECK_EQ(moc->GetLastStatus(), MOC_STATUS_OK);
    CHECK(moc->TestRect(-0.5f, 0.5f, 0.5f, -0.5f, 5) == MOC::VISIBLE);
    EXPECT(MOC_STATUS_OK, "MOC_TestRect: ymin is above ymax");
    CHECK(moc->TestRect(-0.5f, nan, 0.5f, 0.5f, 5) == MOC::VISIBLE);
    EXPECT(MOC_STATUS_OK, "MOC_TestRect: a number is NaN");
    // Not reported: a box that crosses the near plane, edges off screen, an ordinary visible box.
    moc->TestRect(-1, -1, 1, 1, 0);
    moc->TestRect(-inf, -inf, inf, inf, 5);
    moc->TestRect(-0.5f, -0.5f, 0.5f, 0.5f, 5);
    moc->TestRect(-0.5f, -0.5f, -0.5f, -0.5f, 5);
    moc->TestRect(2, 2, 3, 3, 5);
    CHECK(told.empty());
    MOC::Destroy(moc);
}

// A matrix with the layout of clip-space vertices is accepted, but reported.
void MatrixWithTheLayoutOfClipSpace()
{
    const float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 10};
    const MOC::BackfaceWinding winding = MOC::BACKFACE_CW;
    const MOC::ClipPlanes planes = MOC::CLIP_PLANE_ALL;
    float quad[16], data[9 * 4];
    MOC::TriList list = {4, 0, data};
    quad_at(quad, -1, -1, 1, 1, 10);
    MOC *moc = MOC::Create();
    // Rejected for another reason: one message, and none is left over for the next call.
    moc->RenderTriangles(quad, QUAD, 2, matrix);
    EXPECT(MOC_STATUS_NO_BUFFER, "MOC_RenderTriangles: no buffer");
    moc->SetResolution(320, 200);
    CHECK(told.empty());
    moc->RenderTriangles(quad, QUAD, 2, matrix);
    EXPECT(MOC_STATUS_OK, "MOC_RenderTriangles: a matrix with the layout (16, 4, 12)");
    CHECK_EQ(moc->GetLastStatus(), MOC_STATUS_OK);
    moc->TestTriangles(quad, QUAD, 2, matrix);
    EXPECT(MOC_STATUS_OK, "MOC_TestTriangles: a matrix with the layout (16, 4, 12)");
    moc->BinTriangles(quad, QUAD, 2, &list, 1, 1, matrix);
    EXPECT(MOC_STATUS_OK, "MOC_BinTriangles: a matrix with the layout (16, 4, 12)");
    CullingThreadpool pool(0, 1, 1);
    pool.SetBuffer(moc);
    pool.SetMatrix(matrix);
    pool.RenderTriangles(quad, QUAD, 2);
    EXPECT(MOC_STATUS_OK, "MOC_ThreadpoolRenderTriangles: a matrix with the layout (16, 4, 12)");
    pool.SetVertexLayout(MOC::VertexLayout(16, 4, 8));
    pool.RenderTriangles(quad, QUAD, 2);
    pool.Flush();
    moc->RenderTriangles(quad, QUAD, 2);
    moc->RenderTriangles(quad, QUAD, 2, matrix, winding, planes, MOC::VertexLayout(16, 4, 8));
    MOC_Mesh mesh = {};
    mesh.size = sizeof(mesh);
    mesh.vertices = quad;
    mesh.vertex_count = 4;
    mesh.indices = QUAD;
    mesh.triangle_count = 2;
    mesh.model_to_clip = matrix;
    mesh.clip_planes = MOC_CLIP_PLANE_ALL;
    // Without a layout: packed x, y, z.
    CHECK_EQ(MOC_TestMesh(moc, &mesh, nullptr), MOC_STATUS_OK);
    CHECK(told.empty());
    mesh.vertex_count = 2;
    CHECK_EQ(MOC_TestMesh(moc, &mesh, nullptr), MOC_STATUS_INDEX_OUT_OF_RANGE);
    EXPECT(MOC_STATUS_INDEX_OUT_OF_RANGE, "MOC_TestMesh: an index is not below vertex_count");
    pool.SetBuffer(nullptr);
    MOC::Destroy(moc);
}

void Pool()
{
    float quad[16];
    quad_at(quad, -1, -1, 1, 1, 10);
    CullingThreadpool pool(1, 1, 1);
    pool.RenderTriangles(quad, QUAD, 2);
    EXPECT(MOC_STATUS_NO_BUFFER, "MOC_ThreadpoolRenderTriangles: no buffer: call MOC_ThreadpoolSetBuffer first");
    CHECK_EQ(MOC::GetLastStatus(), MOC_STATUS_NO_BUFFER);
    MOC *moc = MOC::Create();
    moc->SetResolution(320, 200);
    pool.SetBuffer(moc);
    pool.RenderTriangles(quad, QUAD, -2);
    EXPECT(MOC_STATUS_INVALID_SIZE, "MOC_ThreadpoolRenderTriangles: n_triangles");
    CHECK(pool.TestRect(0.5f, -0.5f, -0.5f, 0.5f, 5) == MOC::VISIBLE);
    EXPECT(MOC_STATUS_OK, "MOC_ThreadpoolTestRect: xmin is above xmax");
    pool.Flush();
    CHECK(told.empty());
    pool.SetBuffer(nullptr);
    MOC::Destroy(moc);
}

// A callback may call the library; rejections of those calls are not reported, and the status is that of the outer
// call.
int depth = 0;
void Recursive(void *user, int, const char *)
{
    ++depth;
    MOC *moc = static_cast<MOC *>(user);
    moc->SetResolution(0, 0);
    CHECK_EQ(moc->GetLastStatus(), MOC_STATUS_INVALID_SIZE);
    // The callback is not called under a lock.
    MOC::SetMessageCallback(Recursive, user);
}

void CallbacksThatCall()
{
    MOC *moc = MOC::Create();
    MOC::SetMessageCallback(Recursive, moc);
    moc->ClearBuffer();
    CHECK_EQ(depth, 1);
    CHECK_EQ(moc->GetLastStatus(), MOC_STATUS_NO_BUFFER);
    moc->ClearBuffer();
    CHECK_EQ(depth, 2);
    // A message about an accepted call leaves its status OK.
    moc->SetResolution(64, 64);
    moc->TestRect(1, 1, -1, -1, 1);
    CHECK_EQ(depth, 3);
    CHECK_EQ(moc->GetLastStatus(), MOC_STATUS_OK);
    MOC::Destroy(moc);
}

std::atomic<int> heard(0);
void Count(void *user, int, const char *) { static_cast<std::atomic<int> *>(user)->fetch_add(1); }

// Each thread has its own status, and all threads report to the same callback while another thread removes and restores it.
void Threads()
{
    const int threads = 4, rounds = 2000;
    MOC *moc = MOC::Create();
    MOC::SetMessageCallback(Count, &heard);
    std::atomic<bool> ends(false);
    std::thread changes([&] {
        while (!ends) {
            MOC::SetMessageCallback(nullptr);
            MOC::SetMessageCallback(Count, &heard);
        }
    });
    std::vector<std::thread> all;
    for (int t = 0; t < threads; ++t)
        all.push_back(std::thread([=] {
            for (int i = 0; i < rounds; ++i) {
                const bool refused = (i + t) % 2 != 0;
                if (refused)
                    moc->TestRect(-1, -1, 1, 1, 1);
                else
                    moc->GetNearClipPlane();
                CHECK_EQ(MOC::GetLastStatus(), refused ? MOC_STATUS_NO_BUFFER : MOC_STATUS_OK);
            }
        }));
    for (std::thread &thread : all)
        thread.join();
    ends = true;
    changes.join();
    CHECK(heard <= threads * rounds / 2);
    // No message is lost while the callback does not change.
    heard = 0;
    MOC::SetMessageCallback(Count, &heard);
    for (int i = 0; i < 100; ++i)
        moc->TestRect(-1, -1, 1, 1, 1);
    CHECK_EQ(heard.load(), 100);
    MOC::SetMessageCallback(nullptr);
    moc->TestRect(-1, -1, 1, 1, 1);
    CHECK_EQ(heard.load(), 100);
    MOC::Destroy(moc);
}

} // namespace

int main()
{
    Silent();
    MOC::SetMessageCallback(Listen, &told);
    WhatIsRefused();
    OddRectangles();
    MatrixWithTheLayoutOfClipSpace();
    Pool();
    CallbacksThatCall();
    Threads();
    return check_report("messages");
}
