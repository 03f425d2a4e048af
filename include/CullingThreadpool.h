/*
 * CPU occlusion culling on a masked hierarchical depth buffer: a pool of threads that draw.
 *
 * Header-only over the C functions of masked_occlusion_culling.h. C++11; nothing here throws.
 *
 *     CullingThreadpool pool(threads, 4, 4);
 *     pool.SetBuffer(moc);
 *     pool.WakeThreads();
 *     each frame:
 *         pool.ClearBuffer();
 *         pool.SetMatrix(modelToClip);
 *         pool.RenderTriangles(vertices, triangles, count);   // as often as there are occluders
 *         pool.Flush();
 *         moc->TestRect(...) or pool.TestRect(...)
 *
 * Calls take effect in their order, and the buffer gets the same bits as from one thread, whatever the number of
 * threads and bins. RenderTriangles returns at once: its arrays have to stay as they are until Flush; matrices are
 * copied. The object that the pool draws into may be used directly after a Flush, while nobody calls the pool.
 *
 * The threads sleep when there is nothing to do, between SuspendThreads and WakeThreads, and before the first
 * WakeThreads. Whoever flushes a pool whose threads are suspended does their work. A pool may be destroyed at any
 * time: it draws what was submitted first, for which arrays and object still have to be there, and ends its threads.
 *
 * Several threads may call everything at once but the destructor; matrix and vertex layout are the pool's, so that
 * threads that want different ones take turns. TestRect and TestTriangles answer from what is drawn by now: what was
 * submitted and is not drawn yet hides nothing, and neither does what was drawn before a ClearBuffer.
 *
 * SPDX-License-Identifier: Apache-2.0 OR MIT
 */
#pragma once

/* Also where a program includes its headers inside of extern "C". */
extern "C++" {

// Not used here, but the header that this one stands in for has them, and programs rely on it.
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "MaskedOcclusionCulling.h"

class CullingThreadpool
{
public:
    typedef MaskedOcclusionCulling::CullingResult CullingResult;
    typedef MaskedOcclusionCulling::BackfaceWinding BackfaceWinding;
    typedef MaskedOcclusionCulling::ClipPlanes ClipPlanes;
    typedef MaskedOcclusionCulling::VertexLayout VertexLayout;

    /**
     * numThreads: threads besides those that call; 0 is allowed, and where there are fewer processors besides the
     * caller's, there are fewer threads, but one at least. binsW times binsH: the pieces into which the screen is cut;
     * there are no more than four a thread, and none is smaller than 128x64 pixels. maxJobs: batches of calls that may
     * be in flight; a caller who finds no room works until there is. numProcessors: 0 asks the system.
     *
     * Without bins or jobs (0) there is one. Where the system starts no more threads, or for more than 1024, the pool has
     * none, and Flush does the work.
     */
    CullingThreadpool(unsigned int numThreads, unsigned int binsW, unsigned int binsH, unsigned int maxJobs = 32,
                      unsigned int numProcessors = 0)
    {
        const uint32_t w = binsW != 0 ? binsW : 1, h = binsH != 0 ? binsH : 1, jobs = maxJobs != 0 ? maxJobs : 1;
        if (MOC_ThreadpoolCreate(numThreads, w, h, jobs, numProcessors, &mPool) != MOC_STATUS_OK)
            MOC_ThreadpoolCreate(0, w, h, jobs, numProcessors, &mPool);
    }

    /** Draws what was submitted, and ends the threads. */
    ~CullingThreadpool() { MOC_ThreadpoolDestroy(mPool); }

    CullingThreadpool(const CullingThreadpool &) = delete;
    CullingThreadpool &operator=(const CullingThreadpool &) = delete;

    /** Lets the threads work. */
    void WakeThreads() { MOC_ThreadpoolWakeThreads(mPool); }

    /** Lets the threads sleep. What is submitted meanwhile waits for WakeThreads or Flush. */
    void SuspendThreads() { MOC_ThreadpoolSuspendThreads(mPool); }

    /** Waits until everything that was submitted is drawn. */
    void Flush() { MOC_ThreadpoolFlush(mPool); }

    /** Draws into this object from now on, after what was submitted is drawn. */
    void SetBuffer(MaskedOcclusionCulling *moc) { MOC_ThreadpoolSetBuffer(mPool, moc); }

    /** SetResolution of the object, after what was submitted is drawn. */
    MOC_DETAIL_INLINE void SetResolution(unsigned int width, unsigned int height)
    {
        MOC_DetailAllocation<MOC_DETAIL_EXCEPTIONS != 0> allocation;
        MOC_ThreadpoolSetResolution(mPool, width, height);
        allocation.ThrowAgain();
    }

    /** The near plane, in clip-space w, of the calls that follow, and of the object. */
    void SetNearClipPlane(float nearDist) { MOC_ThreadpoolSetNearClipPlane(mPool, nearDist); }

    /** The matrix of the calls that follow, which is copied; null: the vertices are in clip space. */
    void SetMatrix(const float *modelToClipMatrix = nullptr) { MOC_ThreadpoolSetMatrix(mPool, modelToClipMatrix); }

    /** The vertex layout of the calls that follow. With a matrix the third offset names z. */
    void SetVertexLayout(const VertexLayout &vtxLayout = VertexLayout(16, 4, 12))
    {
        const MOC_VertexLayout plain = {vtxLayout.mStride, vtxLayout.mOffsetY, vtxLayout.mOffsetW};
        MOC_ThreadpoolSetVertexLayout(mPool, &plain);
    }

    /** Clears the buffer, in order with the calls around it. */
    void ClearBuffer() { MOC_ThreadpoolClearBuffer(mPool); }

    /** Submits occluders; see MaskedOcclusionCulling::RenderTriangles. */
    void RenderTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                         BackfaceWinding bfWinding = MaskedOcclusionCulling::BACKFACE_CW,
                         ClipPlanes clipPlaneMask = MaskedOcclusionCulling::CLIP_PLANE_ALL)
    {
        MOC_ThreadpoolRenderTriangles(mPool, inVtx, inTris, nTris, bfWinding, clipPlaneMask);
    }

    /** Tests a rectangle against what is drawn by now; see MaskedOcclusionCulling::TestRect. */
    CullingResult TestRect(float xmin, float ymin, float xmax, float ymax, float wmin)
    {
        int32_t result = MOC_VISIBLE;
        MOC_ThreadpoolTestRect(mPool, xmin, ymin, xmax, ymax, wmin, &result);
        return static_cast<CullingResult>(result);
    }

    /** Tests triangles against what is drawn by now; see MaskedOcclusionCulling::TestTriangles. */
    CullingResult TestTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                                BackfaceWinding bfWinding = MaskedOcclusionCulling::BACKFACE_CW,
                                ClipPlanes clipPlaneMask = MaskedOcclusionCulling::CLIP_PLANE_ALL)
    {
        int32_t result = MOC_VISIBLE;
        MOC_ThreadpoolTestTriangles(mPool, inVtx, inTris, nTris, bfWinding, clipPlaneMask, &result);
        return static_cast<CullingResult>(result);
    }

    /** Flushes, and writes the depth of every pixel; see MaskedOcclusionCulling::ComputePixelDepthBuffer. */
    void ComputePixelDepthBuffer(float *depthData, bool flipY)
    {
        MOC_ThreadpoolComputePixelDepthBuffer(mPool, depthData, flipY ? 1 : 0);
    }

    /**
     * Folds other buffers into the pool's, in order with the calls around it, with the result of MergeBuffer one by one. They stay
     * as they are until Flush. Not in the library that this header stands in for.
     */
    void MergeBuffers(const MaskedOcclusionCulling *const *others, unsigned int count)
    {
        MOC_ThreadpoolMergeBuffers(mPool, others, count);
    }

private:
    MOC_Threadpool *mPool = nullptr;
};

} /* extern "C++" */
