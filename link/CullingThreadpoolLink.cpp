/*
 * Intel's thread pool implemented with this library's, for programs whose CullingThreadpool.h cannot change. Compile it
 * instead of CullingThreadpool.cpp, together with MaskedOcclusionCullingLink.cpp, which explains how.
 *
 * Intel's CullingThreadpool.cpp uses the methods of the class and may stay, but its queries must then wait for Flush: it
 * queries while its threads draw, which this library's RenderTrilist does not permit. It also keeps its problems:
 * threads that spin when there is nothing to do, orders of calls that hang, and columns and rows that are lost if the
 * size of the buffer is not a multiple of the tile size.
 *
 * SPDX-License-Identifier: Apache-2.0 OR MIT
 */
#include <stddef.h>

#include "CullingThreadpool.h"

#ifdef MOC_DETAIL_SWITCHES
#error "This found the header of this repository, which needs no such file: put the program's own first in the include path"
#endif
#if MOC_RECORDER_ENABLE
#error "The pool's calls would not be recorded: with MOC_RECORDER_ENABLE 1 keep the program's own CullingThreadpool.cpp"
#endif

#include "LinkedObject.h"

// The header's state is unused, but it must be constructed.
template <class T>
CullingThreadpool::StateData<T>::StateData(unsigned int maxJobs) : mMaxJobs(maxJobs), mCurrentIdx(0), mData(nullptr)
{
}

template <class T> CullingThreadpool::StateData<T>::StateData::~StateData()
{
}

namespace
{

// The pool is stored where the header has a pointer to its queue, whose type is private.
template <class Queue> MOC_Threadpool *PoolOf(Queue *queue)
{
    return reinterpret_cast<MOC_Threadpool *>(queue);
}

} // namespace

CullingThreadpool::CullingThreadpool(unsigned int numThreads, unsigned int binsW, unsigned int binsH,
                                     unsigned int maxJobs)
    : mNumThreads(numThreads), mNumBins(binsW * binsH), mMaxJobs(maxJobs), mBinsW(binsW), mBinsH(binsH),
      mKillThreads(false), mSuspendThreads(true), mNumSuspendedThreads(0), mThreads(nullptr), mCurrentMatrix(nullptr),
      mModelToClipMatrices(maxJobs), mVertexLayouts(maxJobs), mRenderQueue(nullptr), mRects(nullptr), mMOC(nullptr)
{
    const uint32_t w = binsW != 0 ? binsW : 1, h = binsH != 0 ? binsH : 1, jobs = maxJobs != 0 ? maxJobs : 1;
    MOC_Threadpool *pool = nullptr;
    // If the system cannot start threads, the pool has none, and Flush does the work.
    if (MOC_ThreadpoolCreate(numThreads, w, h, jobs, 0, &pool) != MOC_STATUS_OK)
        MOC_ThreadpoolCreate(0, w, h, jobs, 0, &pool);
    mRenderQueue = reinterpret_cast<RenderJobQueue *>(pool);
}

CullingThreadpool::~CullingThreadpool()
{
    MOC_ThreadpoolDestroy(PoolOf(mRenderQueue));
}

void CullingThreadpool::WakeThreads()
{
    MOC_ThreadpoolWakeThreads(PoolOf(mRenderQueue));
}

void CullingThreadpool::SuspendThreads()
{
    MOC_ThreadpoolSuspendThreads(PoolOf(mRenderQueue));
}

void CullingThreadpool::Flush()
{
    MOC_ThreadpoolFlush(PoolOf(mRenderQueue));
}

void CullingThreadpool::SetBuffer(MaskedOcclusionCulling *moc)
{
    MOC_ThreadpoolSetBuffer(PoolOf(mRenderQueue), moc_link::ObjectOf(moc));
}

void CullingThreadpool::SetResolution(unsigned int width, unsigned int height)
{
    moc_link::Allocation allocation;
    MOC_ThreadpoolSetResolution(PoolOf(mRenderQueue), width, height);
    allocation.ThrowAgain();
}

void CullingThreadpool::SetNearClipPlane(float nearDist)
{
    MOC_ThreadpoolSetNearClipPlane(PoolOf(mRenderQueue), nearDist);
}

void CullingThreadpool::SetMatrix(const float *modelToClipMatrix)
{
    MOC_ThreadpoolSetMatrix(PoolOf(mRenderQueue), modelToClipMatrix);
}

void CullingThreadpool::SetVertexLayout(const VertexLayout &vtxLayout)
{
    const MOC_VertexLayout layout = moc_link::Layout(vtxLayout);
    MOC_ThreadpoolSetVertexLayout(PoolOf(mRenderQueue), &layout);
}

void CullingThreadpool::ClearBuffer()
{
    MOC_ThreadpoolClearBuffer(PoolOf(mRenderQueue));
}

void CullingThreadpool::RenderTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                                        BackfaceWinding bfWinding, ClipPlanes clipPlaneMask)
{
    MOC_ThreadpoolRenderTriangles(PoolOf(mRenderQueue), inVtx, inTris, nTris, bfWinding, clipPlaneMask);
}

CullingThreadpool::CullingResult CullingThreadpool::TestRect(float xmin, float ymin, float xmax, float ymax, float wmin)
{
    int32_t result = MOC_VISIBLE;
    MOC_ThreadpoolTestRect(PoolOf(mRenderQueue), xmin, ymin, xmax, ymax, wmin, &result);
    return static_cast<CullingResult>(result);
}

CullingThreadpool::CullingResult CullingThreadpool::TestTriangles(const float *inVtx, const unsigned int *inTris,
                                                                  int nTris, BackfaceWinding bfWinding,
                                                                  ClipPlanes clipPlaneMask)
{
    int32_t result = MOC_VISIBLE;
    MOC_ThreadpoolTestTriangles(PoolOf(mRenderQueue), inVtx, inTris, nTris, bfWinding, clipPlaneMask, &result);
    return static_cast<CullingResult>(result);
}

void CullingThreadpool::ComputePixelDepthBuffer(float *depthData, bool flipY)
{
    MOC_ThreadpoolComputePixelDepthBuffer(PoolOf(mRenderQueue), depthData, flipY ? 1 : 0);
}
