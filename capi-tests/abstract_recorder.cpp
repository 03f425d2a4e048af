// The recording methods: link/ calls them, and the program defines them, as with Intel's library.
#include "check.h"

#include "FrameRecorder.h"

namespace
{

typedef MaskedOcclusionCulling MOC;

FrameRecorder recorder;
int stops = 0;

} // namespace

bool MaskedOcclusionCulling::RecorderStart(const char *) const
{
    mRecorder = &recorder;
    return true;
}

void MaskedOcclusionCulling::RecorderStop() const
{
    CHECK(mRecorder != nullptr); // otherwise it would crash
    mRecorder = nullptr;
    stops++;
}

void MaskedOcclusionCulling::RecordRenderTriangles(const float *, const unsigned int *, int nTris, const float *,
                                                   ClipPlanes clipPlaneMask, BackfaceWinding bfWinding,
                                                   const VertexLayout &, CullingResult cullingResult)
{
    if (mRecorder == nullptr)
        return;
    CHECK(nTris == 2 && clipPlaneMask == CLIP_PLANE_ALL && bfWinding == BACKFACE_CW && cullingResult == VISIBLE);
    mRecorder->mDraws++;
}

int main()
{
    float wall[16];
    quad_at(wall, -1, -1, 1, 1, 10);
    MOC *moc = MOC::Create();
    moc->SetResolution(64, 64);
    for (int recording = 0; recording < 3; recording++) {
        if (recording == 1)
            CHECK(moc->RecorderStart("somewhere"));
        if (recording == 2)
            moc->RecorderStop();
        moc->ClearBuffer();
        CHECK(moc->RenderTriangles(wall, QUAD, 2) == MOC::VISIBLE);
        CHECK(moc->TestRect(-1, -1, 1, 1, 20) == MOC::OCCLUDED);
        CHECK(moc->TestRect(-1, -1, 1, 1, 5) == MOC::VISIBLE);
        CHECK(moc->TestTriangles(wall, QUAD, 2) == MOC::VISIBLE);
        CHECK_EQ(recorder.mClears, recording != 0);
        CHECK_EQ(recorder.mDraws, recording != 0);
        CHECK_EQ(recorder.mRects, recording != 0 ? 2 : 0);
        CHECK_EQ(recorder.mMeshes, recording != 0);
    }
    MOC::Destroy(moc);
    CHECK_EQ(stops, 1);

    // An object that is destroyed while recording is stopped first.
    moc = MOC::Create();
    moc->RecorderStart("somewhere");
    MOC::Destroy(moc);
    CHECK_EQ(stops, 2);
    return check_report("abstract_recorder");
}
