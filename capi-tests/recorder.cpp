// The frame recorder through its C++ classes: a recorded frame is loaded and replayed with the same answers and pixels,
// and so are calls recorded by hand. Truncated, corrupt or missing files are rejected.
#define MOC_RECORDER_ENABLE 1
#define MOC_RECORDER_ENABLE_PLAYBACK 1
#include "FrameRecorder.h"

#include "CullingThreadpool.h"
#include "check.h"

#include <string>

#ifdef _WIN32
#include "small_windows.h"
#endif

namespace
{

typedef MaskedOcclusionCulling MOC;

const char *const FILE_NAME = "capi-tests-recorder.mocrec";

// x' = x, y' = y, w' = z.
const float Z_TO_W[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0};

std::vector<float> Depths(const MOC &moc)
{
    unsigned int width, height;
    moc.GetResolution(width, height);
    std::vector<float> depths(width * height);
    moc.ComputePixelDepthBuffer(depths.data(), false);
    return depths;
}

// Replays a recording as engines do; returns how many answers differ from those recorded.
int Play(MOC &moc, const FrameRecording &recording)
{
    int differ = 0;
    moc.SetResolution(recording.mResolutionWidth, recording.mResolutionHeight);
    moc.SetNearClipPlane(recording.mNearClipPlane);
    for (size_t i = 0; i < recording.mPlaybackOrder.size(); ++i)
    {
        const int index = recording.mPlaybackOrder[i].second;
        int recorded = -1, answer = -1;
        switch (recording.mPlaybackOrder[i].first)
        {
        case 1:
        {
            const FrameRecording::RectEntry &rect = recording.mRectEntries[index];
            recorded = rect.mCullingResult;
            answer = moc.TestRect(rect.mXMin, rect.mYMin, rect.mXMax, rect.mYMax, rect.mWMin);
            break;
        }
        case 0:
        case 2:
        {
            const FrameRecording::TrianglesEntry &mesh = recording.mTriangleEntries[index];
            const float *matrix = mesh.mHasModelToClipMatrix ? mesh.mModelToClipMatrix : nullptr;
            const int triangles = static_cast<int>(mesh.mTriangles.size() / 3);
            CHECK(!mesh.mHasScissorRect);
            recorded = mesh.mCullingResult;
            answer = recording.mPlaybackOrder[i].first == 0
                         ? moc.RenderTriangles(mesh.mVertices.data(), mesh.mTriangles.data(), triangles, matrix,
                                               mesh.mbfWinding, mesh.mClipPlaneMask, mesh.mVertexLayout)
                         : moc.TestTriangles(mesh.mVertices.data(), mesh.mTriangles.data(), triangles, matrix,
                                             mesh.mbfWinding, mesh.mClipPlaneMask, mesh.mVertexLayout);
            break;
        }
        case 3:
            CHECK_EQ(index, -1);
            moc.ClearBuffer();
            break;
        default:
            CHECK(!"a kind of call");
        }
        differ += recorded != -1 && recorded != answer;
    }
    return differ;
}

void RecordAndPlay()
{
    MOC *moc = MOC::Create();
    CHECK(!moc->RecorderStart(FILE_NAME)); // no buffer
    moc->RecorderStop();
    moc->SetResolution(200, 120);
    CHECK(!moc->RecorderStart("no/such/folder/frame.mocrec"));
    CHECK(!moc->RecorderStart(nullptr));
    CHECK(moc->RecorderStart(FILE_NAME));
    CHECK(!moc->RecorderStart(FILE_NAME));
    // The file's header is not written before the first call, so the settings can still change.
    moc->SetNearClipPlane(0.25f);
    moc->ClearBuffer();
    float vertices[16];
    const float positions[12] = {-0.4f, -0.4f, 5, 0.4f, -0.4f, 5, 0.4f, 0.4f, 5, -0.4f, 0.4f, 5};
    quad_at(vertices, -0.5f, -0.5f, 0.5f, 0.5f, 4.0f);
    CHECK_EQ(moc->RenderTriangles(vertices, QUAD, 2, nullptr, MOC::BACKFACE_NONE), MOC::VISIBLE);
    CHECK_EQ(moc->TestRect(-0.1f, -0.1f, 0.1f, 0.1f, 5.0f), MOC::OCCLUDED);
    CHECK_EQ(moc->TestRect(2.1f, -0.1f, 2.2f, 0.1f, 5.0f), MOC::VIEW_CULLED);
    CHECK_EQ(moc->TestTriangles(positions, QUAD, 2, Z_TO_W, MOC::BACKFACE_CW, MOC::CLIP_PLANE_NEAR,
                                MOC::VertexLayout(12, 4, 8)),
             MOC::OCCLUDED);
    // Rejected, and therefore not recorded.
    moc->RenderTriangles(vertices, QUAD, -1);
    moc->RecordRenderTriangles(positions, QUAD, 1, Z_TO_W, MOC::CLIP_PLANE_SIDES, MOC::BACKFACE_CCW,
                               MOC::VertexLayout(12, 4, 8));
    moc->RecordRenderTriangles(vertices, QUAD, 2);
    moc->RecorderStop();
    moc->ClearBuffer();

    FrameRecording recording;
    CHECK(FrameRecording::Load(FILE_NAME, recording));
    const char kinds[] = {3, 0, 1, 1, 2, 0, 0};
    CHECK_EQ(recording.mPlaybackOrder.size(), sizeof(kinds));
    for (size_t i = 0; i < recording.mPlaybackOrder.size() && i < sizeof(kinds); ++i)
        CHECK_EQ(recording.mPlaybackOrder[i].first, kinds[i]);
    CHECK_EQ(recording.mResolutionWidth, 200);
    CHECK_EQ(recording.mResolutionHeight, 120);
    CHECK(recording.mNearClipPlane == 0.25f);
    CHECK_EQ(recording.mTriangleEntries[0].mVertexLayout.mOffsetW, 12);
    CHECK_EQ(recording.mTriangleEntries[1].mClipPlaneMask, MOC::CLIP_PLANE_NEAR);
    CHECK_EQ(recording.mTriangleEntries[2].mCullingResult, -1);
    CHECK_EQ(recording.mTriangleEntries[2].mbfWinding, MOC::BACKFACE_CCW);
    CHECK_EQ(recording.mTriangleEntries[2].mClipPlaneMask, MOC::CLIP_PLANE_SIDES);
    // Of a quad's vertices, one triangle uses three.
    CHECK_EQ(recording.mTriangleEntries[2].mVertices.size(), 9);

    MOC *again = MOC::Create();
    CHECK_EQ(Play(*again, recording), 0);
    CHECK_EQ(again->TestRect(-0.1f, -0.1f, 0.1f, 0.1f, 5.0f), MOC::OCCLUDED);

    // The same for the copy that is recorded while it is replayed.
    CHECK(again->RecorderStart(FILE_NAME));
    CHECK_EQ(Play(*again, recording), 0);
    again->RecorderStop();
    FrameRecording copy;
    CHECK(FrameRecording::Load(FILE_NAME, copy));
    CHECK_EQ(copy.mPlaybackOrder.size(), recording.mPlaybackOrder.size() + 1); // SetResolution clears
    CHECK(copy.mTriangleEntries[2].mVertices == recording.mTriangleEntries[2].mVertices);
    CHECK_EQ(Play(*moc, copy), 0);
    CHECK(Depths(*moc) == Depths(*again));
    MOC::Destroy(again);
    MOC::Destroy(moc);
}

void RecordAPool()
{
    std::vector<float> vertices(12 * 300);
    std::vector<unsigned int> indices(3 * 300);
    random_triangles(vertices.data(), indices.data(), 300, 5);
    MOC *moc = MOC::Create(), *again = MOC::Create();
    moc->SetResolution(300, 200);
    CHECK(moc->RecorderStart(FILE_NAME));
    {
        CullingThreadpool pool(2, 3, 3);
        pool.SetBuffer(moc);
        pool.WakeThreads();
        pool.ClearBuffer();
        pool.RenderTriangles(vertices.data(), indices.data(), 300, MOC::BACKFACE_NONE);
        pool.RenderTriangles(vertices.data(), indices.data(), 100, MOC::BACKFACE_CCW);
        pool.Flush();
        pool.TestRect(-0.5f, -0.5f, 0.5f, 0.5f, 50.0f);
    }
    moc->RecorderStop();
    FrameRecording recording;
    CHECK(FrameRecording::Load(FILE_NAME, recording));
    CHECK_EQ(recording.mPlaybackOrder.size(), 4);
    CHECK_EQ(recording.mTriangleEntries[0].mCullingResult, -1);
    CHECK(recording.mRectEntries[0].mCullingResult != -1);
    CHECK_EQ(Play(*again, recording), 0);
    CHECK(Depths(*again) == Depths(*moc));
    MOC::Destroy(again);
    MOC::Destroy(moc);
}

void Refused()
{
    FrameRecording recording;
    CHECK(FrameRecording::Load(FILE_NAME, recording));
    CHECK(!FrameRecording::Load("no such file", recording));
    CHECK(recording.mPlaybackOrder.empty());
    CHECK(!FrameRecording::Load(nullptr, recording));

    std::vector<unsigned char> bytes;
    FILE *file = fopen(FILE_NAME, "rb");
    for (int c = fgetc(file); c != EOF; c = fgetc(file))
        bytes.push_back(static_cast<unsigned char>(c));
    fclose(file);
    MOC_Recording *loaded = nullptr;
    CHECK_EQ(MOC_RecordingFromMemory(bytes.data(), bytes.size(), &loaded), MOC_STATUS_OK);
    MOC_RecordedCall call = {};
    MOC_RecordingInfo info = {};
    CHECK_EQ(MOC_RecordingGetInfo(loaded, &info), MOC_STATUS_INVALID_SIZE);
    CHECK_EQ(MOC_RecordingGetCall(loaded, 0, &call), MOC_STATUS_INVALID_SIZE);
    call.size = sizeof(call);
    info.size = sizeof(info);
    CHECK_EQ(MOC_RecordingGetInfo(loaded, &info), MOC_STATUS_OK);
    CHECK(info.num_calls > 0);
    // Repeating the calls gives the recorded answers.
    MOC *again = MOC::Create();
    again->SetResolution(info.width, info.height);
    again->SetNearClipPlane(info.near_clip_plane);
    for (uint32_t k = 0; k < info.num_calls; ++k)
    {
        int32_t answer = MOC_RESULT_UNKNOWN;
        CHECK_EQ(MOC_RecordingGetCall(loaded, k, &call), MOC_STATUS_OK);
        CHECK((call.mesh != nullptr) == (call.kind == MOC_RECORDED_RENDER_TRIANGLES || call.kind == MOC_RECORDED_TEST_TRIANGLES));
        if (call.kind == MOC_RECORDED_CLEAR_BUFFER)
            again->ClearBuffer();
        else if (call.kind == MOC_RECORDED_TEST_RECT)
            answer = again->TestRect(call.rect[0], call.rect[1], call.rect[2], call.rect[3], call.rect[4]);
        else if (call.kind == MOC_RECORDED_RENDER_TRIANGLES)
            CHECK_EQ(MOC_RenderMesh(again, call.mesh, &answer), MOC_STATUS_OK);
        else
            CHECK_EQ(MOC_TestMesh(again, call.mesh, &answer), MOC_STATUS_OK);
        CHECK(call.result == MOC_RESULT_UNKNOWN || call.result == answer);
    }
    MOC::Destroy(again);
    CHECK_EQ(MOC_RecordingGetCall(loaded, info.num_calls, &call), MOC_STATUS_INDEX_OUT_OF_RANGE);
    CHECK_EQ(MOC_RecordingGetCall(loaded, 0, nullptr), MOC_STATUS_NULL_POINTER);
    CHECK_EQ(MOC_RecordingGetInfo(nullptr, &info), MOC_STATUS_NULL_POINTER);
    CHECK_EQ(MOC_RecordingDestroy(loaded), MOC_STATUS_OK);
    CHECK_EQ(MOC_RecordingDestroy(nullptr), MOC_STATUS_OK);
    for (size_t size = 0; size < bytes.size(); size += 1 + size / 64)
    {
        // Allocated to exactly this length, so that any read past the end is detected.
        const std::vector<unsigned char> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
        CHECK_EQ(MOC_RecordingFromMemory(cut.data(), size, &loaded), MOC_STATUS_INVALID_RECORDING);
        CHECK(loaded == nullptr);
    }
    CHECK_EQ(MOC_RecordingFromMemory(nullptr, 4, &loaded), MOC_STATUS_NULL_POINTER);
    CHECK_EQ(MOC_RecordingFromMemory(bytes.data(), bytes.size(), nullptr), MOC_STATUS_NULL_POINTER);
    CHECK_EQ(MOC_RecorderStart(nullptr, FILE_NAME), MOC_STATUS_NULL_POINTER);
    CHECK_EQ(MOC_RecorderStop(nullptr), MOC_STATUS_NULL_POINTER);
    uint32_t state = 9;
    for (int round = 0; round < 3000; ++round)
    {
        std::vector<unsigned char> broken(bytes);
        for (int k = 0; k < 3; ++k)
            broken[next_random(&state) % broken.size()] = static_cast<unsigned char>(next_random(&state));
        if (MOC_RecordingFromMemory(broken.data(), broken.size(), &loaded) == MOC_STATUS_OK)
            MOC_RecordingDestroy(loaded);
    }
}

// Helpers for files with UTF-8 names: converted to UTF-16 on Windows, used as bytes elsewhere.
#ifdef _WIN32
std::wstring Wide(const char *name)
{
    wchar_t wide[64];
    const int length = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, name, -1, wide, 64);
    CHECK(length > 0);
    return length > 0 ? std::wstring(wide) : std::wstring();
}

bool Exists(const char *name) { return GetFileAttributesW(Wide(name).c_str()) != INVALID_FILE_ATTRIBUTES; }
bool Remove(const char *name) { return DeleteFileW(Wide(name).c_str()) != 0; }
#else
bool Exists(const char *name)
{
    FILE *file = fopen(name, "rb");
    return file != nullptr && fclose(file) == 0;
}
bool Remove(const char *name) { return remove(name) == 0; }
#endif

// Names that no single code page covers: characters of two, three and four bytes, and a folder named with them.
void NamesBeyondAscii()
{
    MOC *moc = MOC::Create();
    moc->SetResolution(64, 32);
    for (const char *name : {"\xc3\xa4\xc3\xb6\xc3\xbc.mocrec", "\xe6\x97\xa5\xe6\x9c\xac \xd0\x96.mocrec",
                             "\xf0\x9f\x98\x80\xf0\x9f\xa6\x80.mocrec"})
    {
        CHECK(!Exists(name));
        CHECK(moc->RecorderStart(name));
        moc->ClearBuffer();
        CHECK_EQ(MOC_RecorderStop(moc), MOC_STATUS_OK);
        CHECK(Exists(name));
        FrameRecording recording;
        CHECK(FrameRecording::Load(name, recording));
        CHECK_EQ(recording.mPlaybackOrder.size(), 1);
        CHECK(Remove(name));
        CHECK(!Exists(name));
        CHECK(!FrameRecording::Load(name, recording));
    }

    // Not UTF-8: a stray byte, a truncated character, half a surrogate pair. They are valid file names elsewhere, but not on
    // Windows.
    for (const char *name : {"\xff.mocrec", "\xe6\x97", "\xed\xa0\x80.mocrec"})
    {
        MOC_Recording *recording = nullptr;
#ifdef _WIN32
        CHECK_EQ(MOC_RecorderStart(moc, name), MOC_STATUS_FILE);
        CHECK_EQ(MOC_RecordingLoad(name, &recording), MOC_STATUS_FILE);
        CHECK(recording == nullptr);
#else
        const MOC_Status status = MOC_RecorderStart(moc, name);
#ifdef __linux__
        CHECK_EQ(status, MOC_STATUS_OK);
#endif
        // Other systems may reject such names.
        if (status == MOC_STATUS_OK)
        {
            moc->ClearBuffer();
            CHECK_EQ(MOC_RecorderStop(moc), MOC_STATUS_OK);
            CHECK(Exists(name));
            CHECK_EQ(MOC_RecordingLoad(name, &recording), MOC_STATUS_OK);
            CHECK_EQ(MOC_RecordingDestroy(recording), MOC_STATUS_OK);
            CHECK(Remove(name));
        }
#endif
    }
    // The object still records.
    CHECK(moc->RecorderStart(FILE_NAME));
    moc->RecorderStop();
    MOC::Destroy(moc);
}

} // namespace

int main()
{
    RecordAndPlay();
    RecordAPool();
    Refused();
    NamesBeyondAscii();
    remove(FILE_NAME);
    return check_report("recorder");
}
