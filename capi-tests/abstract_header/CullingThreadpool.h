// The pool for the class in this folder: the methods of this library's pool, and what link/ needs to know of the rest.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "MaskedOcclusionCulling.h"

class CullingThreadpool
{
protected:
    typedef MaskedOcclusionCulling::CullingResult CullingResult;
    typedef MaskedOcclusionCulling::ClipPlanes ClipPlanes;
    typedef MaskedOcclusionCulling::BackfaceWinding BackfaceWinding;
    typedef MaskedOcclusionCulling::ScissorRect ScissorRect;
    typedef MaskedOcclusionCulling::VertexLayout VertexLayout;

    struct Matrix4x4
    {
        float mValues[16];
    };
    struct RenderJobQueue;

    template <class T> struct StateData
    {
        unsigned int mMaxJobs, mCurrentIdx;
        T *mData;

        StateData(unsigned int maxJobs);
        ~StateData();
    };

    unsigned int mNumThreads, mNumBins, mMaxJobs, mBinsW, mBinsH;
    std::mutex mSuspendedMutex;
    std::condition_variable mSuspendedCV;
    volatile bool mKillThreads, mSuspendThreads;
    volatile unsigned int mNumSuspendedThreads;
    std::thread *mThreads;
    const float *mCurrentMatrix;
    StateData<Matrix4x4> mModelToClipMatrices;
    StateData<VertexLayout> mVertexLayouts;
    RenderJobQueue *mRenderQueue;
    ScissorRect *mRects;
    MaskedOcclusionCulling *mMOC;

public:
    CullingThreadpool(unsigned int numThreads, unsigned int binsW, unsigned int binsH, unsigned int maxJobs = 32);
    ~CullingThreadpool();

    void WakeThreads();
    void SuspendThreads();
    void Flush();
    void SetBuffer(MaskedOcclusionCulling *moc);
    void SetResolution(unsigned int width, unsigned int height);
    void SetNearClipPlane(float nearDist);
    void SetMatrix(const float *modelToClipMatrix = nullptr);
    void SetVertexLayout(const VertexLayout &vtxLayout = VertexLayout(16, 4, 12));
    void ClearBuffer();
    void RenderTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                         BackfaceWinding bfWinding = MaskedOcclusionCulling::BACKFACE_CW,
                         ClipPlanes clipPlaneMask = MaskedOcclusionCulling::CLIP_PLANE_ALL);
    CullingResult TestRect(float xmin, float ymin, float xmax, float ymax, float wmin);
    CullingResult TestTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                                BackfaceWinding bfWinding = MaskedOcclusionCulling::BACKFACE_CW,
                                ClipPlanes clipPlaneMask = MaskedOcclusionCulling::CLIP_PLANE_ALL);
    void ComputePixelDepthBuffer(float *depthData, bool flipY);
};
