/*
 * CPU occlusion culling on a masked hierarchical depth buffer: a pool of threads that draw.
 *
 * Header-only over the C functions of masked_occlusion_culling.h. A library built without the feature `pool` lacks those of
 * the pool, which shows when linking. C++11; nothing here throws.
 *
 *     CullingThreadpool pool(threads, 4, 4);
 *     moc->SetResolution(640, 360);
 *     pool.SetBuffer(moc);
 *     pool.SetNearClipPlane(0.1f);
 *     pool.SetVertexLayout(MaskedOcclusionCulling::VertexLayout(12, 4, 8));  // x, y, z: the default is for clip space
 *     pool.WakeThreads();
 *     each frame:
 *         pool.ClearBuffer();
 *         pool.SetMatrix(modelToClip);
 *         pool.RenderTriangles(vertices, triangles, count);   // as often as there are occluders
 *         pool.Flush();
 *         moc->TestRect(...) or pool.TestRect(...)
 *
 * Calls take effect in their order, and the buffer gets the same bits as from one thread, whatever the number of
 * threads and bins. RenderTriangles returns at once. Its arrays must stay unchanged until Flush, ClearBuffer, SetNearClipPlane,
 * SetBuffer or SetResolution returns (each waits until everything submitted is drawn), or until maxJobs later calls have
 * returned: a program that rotates among maxJobs + 1 arrays needs no Flush. Matrices are copied.
 *
 * While a worker thread is awake, submitted work is drawn without a further call. With none awake, or none at all, it waits for
 * WakeThreads, Flush, SuspendThreads or WorkOnce. The threads sleep when there is nothing to do, between SuspendThreads and
 * WakeThreads, and before the first WakeThreads.
 *
 * The object that the pool draws into may be queried directly by any thread, except while SetBuffer or SetResolution runs. It
 * may be drawn into directly while no thread calls the pool: its methods first wait for work in flight, except
 * GetNumDroppedTriangles and GetStatistics, which count what has been drawn so far, and SetNearClipPlane, which applies to
 * later draws. Pool and object may be destroyed in either order; whichever goes first, what was submitted is drawn before, so
 * the arrays must still exist.
 *
 * Several threads may call everything but the destructor concurrently. SetMatrix and SetVertexLayout apply to later calls on
 * the same thread; a thread that has never called either uses what any thread set last. The overloads with a matrix need
 * neither. A matrix with the default layout (16, 4, 12) reads the fourth float of each vertex as z, which draws nothing
 * useful: set both. TestRect and TestTriangles answer from what has been drawn so far: work that is submitted but not yet drawn hides
 * nothing.
 *
 * SPDX-License-Identifier: Apache-2.0 OR MIT
 */
#pragma once

/* For programs that include this header inside extern "C". */
extern "C++" {

// Not used here, but the header that this one replaces includes them, and programs rely on that.
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "MaskedOcclusionCulling.h"

#include "moc_names.h"

MOC_NAMESPACE_BEGIN

class CullingThreadpool
{
public:
    typedef MaskedOcclusionCulling::CullingResult CullingResult;
    typedef MaskedOcclusionCulling::BackfaceWinding BackfaceWinding;
    typedef MaskedOcclusionCulling::ClipPlanes ClipPlanes;
    typedef MaskedOcclusionCulling::VertexLayout VertexLayout;

    /**
     * numThreads: threads besides the calling ones; may be 0. If there are fewer processors besides the caller's, fewer
     * threads are started, but at least one. binsW times binsH: the bins that the screen is divided into; there are at
     * most four per thread, and none is smaller than 128x64 pixels. maxJobs: how many calls' arrays may still be read
     * when RenderTriangles returns; beyond that the caller helps until this is so again. Small calls are gathered into
     * batches of at most half as many, so a larger maxJobs makes them cheaper. numProcessors: 0 means as many as the
     * system reports.
     *
     * If a number of bins or maxJobs is 0, 1 is used. If the system cannot start the threads, or numThreads is above
     * 1024, the pool has no threads, and Flush does the work.
     */
    CullingThreadpool(unsigned int numThreads, unsigned int binsW, unsigned int binsH, unsigned int maxJobs = 32,
                      unsigned int numProcessors = 0)
    {
        const uint32_t w = binsW != 0 ? binsW : 1, h = binsH != 0 ? binsH : 1, jobs = maxJobs != 0 ? maxJobs : 1;
        if (MOC_ThreadpoolCreate(numThreads, w, h, jobs, numProcessors, &mPool) != MOC_STATUS_OK)
            MOC_ThreadpoolCreate(0, w, h, jobs, numProcessors, &mPool);
    }

    /**
     * The same with more settings: pools whose work is done by the program's own job system, thread names, and a callback when
     * a thread starts. If the settings are refused, the pool has no threads and one bin.
     */
    explicit CullingThreadpool(const MOC_ThreadpoolSettings &settings)
    {
        if (MOC_ThreadpoolCreateFrom(&settings, &mPool) != MOC_STATUS_OK)
            MOC_ThreadpoolCreate(0, 1, 1, 32, 0, &mPool);
    }

    /** Draws everything submitted, and ends the threads. */
    ~CullingThreadpool() { MOC_ThreadpoolDestroy(mPool); }

    CullingThreadpool(const CullingThreadpool &) = delete;
    CullingThreadpool &operator=(const CullingThreadpool &) = delete;

    /** Wakes the threads, so that they draw what is submitted. */
    void WakeThreads() { MOC_ThreadpoolWakeThreads(mPool); }

    /** Draws everything submitted, then puts the threads to sleep. */
    void SuspendThreads() { MOC_ThreadpoolSuspendThreads(mPool); }

    /** Waits until everything submitted is drawn. */
    void Flush() { MOC_ThreadpoolFlush(mPool); }

    /**
     * Does one piece of pending work on the calling thread and returns: for jobs of the program's own job system.
     * Returns false if nothing is pending that is not already being worked on.
     */
    bool WorkOnce()
    {
        int32_t worked = 0;
        MOC_ThreadpoolWorkOnce(mPool, &worked);
        return worked != 0;
    }

    /** Whether everything submitted is drawn. Calling WorkOnce in a loop until then is a Flush that never sleeps. */
    bool IsDone() const
    {
        int32_t done = 1;
        MOC_ThreadpoolIsDone(mPool, &done);
        return done != 0;
    }

    /** The number of worker threads the pool actually has. */
    unsigned int GetNumThreads() const
    {
        uint32_t threads = 0;
        MOC_ThreadpoolGetThreads(mPool, &threads);
        return threads;
    }

    /** The actual number of columns and rows of bins; 0 by 0 without an object that has a resolution. */
    void GetNumBins(unsigned int &binsW, unsigned int &binsH) const
    {
        uint32_t w = 0, h = 0;
        MOC_ThreadpoolGetBins(mPool, &w, &h);
        binsW = w;
        binsH = h;
    }

    /**
     * Draws into this object from now on, once everything submitted before is drawn. The object keeps its near plane.
     * An object that belongs to another pool is refused.
     */
    void SetBuffer(MaskedOcclusionCulling *moc) { MOC_ThreadpoolSetBuffer(mPool, moc); }

    /** SetResolution of the object, once everything submitted is drawn. No thread may query the object itself meanwhile. */
    MOC_DETAIL_INLINE void SetResolution(unsigned int width, unsigned int height)
    {
        MOC_DetailAllocation<MOC_DETAIL_EXCEPTIONS != 0> allocation;
        MOC_ThreadpoolSetResolution(mPool, width, height);
        allocation.ThrowAgain();
    }

    /** Flush, then SetNearClipPlane of the object. */
    void SetNearClipPlane(float nearDist) { MOC_ThreadpoolSetNearClipPlane(mPool, nearDist); }

    /** Sets the matrix of this thread's later calls, which is copied; null: the vertices are in clip space. */
    void SetMatrix(const float *modelToClipMatrix = nullptr) { MOC_ThreadpoolSetMatrix(mPool, modelToClipMatrix); }

    /** Sets the vertex layout of this thread's later calls. With a matrix the third offset is that of z. */
    void SetVertexLayout(const VertexLayout &vtxLayout = VertexLayout(16, 4, 12))
    {
        const MOC_VertexLayout plain = {vtxLayout.mStride, vtxLayout.mOffsetY, vtxLayout.mOffsetW};
        MOC_ThreadpoolSetVertexLayout(mPool, &plain);
    }

    /** Flush, then ClearBuffer of the object. */
    void ClearBuffer() { MOC_ThreadpoolClearBuffer(mPool); }

    /** Submits occluders; see MaskedOcclusionCulling::RenderTriangles. */
    void RenderTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                         BackfaceWinding bfWinding = MaskedOcclusionCulling::BACKFACE_CW,
                         ClipPlanes clipPlaneMask = MaskedOcclusionCulling::CLIP_PLANE_ALL)
    {
        MOC_ThreadpoolRenderTriangles(mPool, inVtx, inTris, nTris, bfWinding, clipPlaneMask);
    }

    /** The same with its own matrix and layout; the arguments are those of MaskedOcclusionCulling::RenderTriangles. */
    void RenderTriangles(const float *inVtx, const unsigned int *inTris, int nTris, const float *modelToClipMatrix,
                         BackfaceWinding bfWinding = MaskedOcclusionCulling::BACKFACE_CW,
                         ClipPlanes clipPlaneMask = MaskedOcclusionCulling::CLIP_PLANE_ALL,
                         const VertexLayout &vtxLayout = VertexLayout(16, 4, 12))
    {
        const Described described(inVtx, inTris, nTris, modelToClipMatrix, bfWinding, clipPlaneMask, vtxLayout);
        MOC_ThreadpoolRenderMesh(mPool, &described.mesh);
    }

    /** Tests a rectangle against what has been drawn so far; see MaskedOcclusionCulling::TestRect. */
    CullingResult TestRect(float xmin, float ymin, float xmax, float ymax, float wmin)
    {
        int32_t result = MOC_VISIBLE;
        MOC_ThreadpoolTestRect(mPool, xmin, ymin, xmax, ymax, wmin, &result);
        return static_cast<CullingResult>(result);
    }

    /** Tests triangles against what has been drawn so far; see MaskedOcclusionCulling::TestTriangles. */
    CullingResult TestTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                                BackfaceWinding bfWinding = MaskedOcclusionCulling::BACKFACE_CW,
                                ClipPlanes clipPlaneMask = MaskedOcclusionCulling::CLIP_PLANE_ALL)
    {
        int32_t result = MOC_VISIBLE;
        MOC_ThreadpoolTestTriangles(mPool, inVtx, inTris, nTris, bfWinding, clipPlaneMask, &result);
        return static_cast<CullingResult>(result);
    }

    /** The same with its own matrix and layout; the arguments are those of MaskedOcclusionCulling::TestTriangles. */
    CullingResult TestTriangles(const float *inVtx, const unsigned int *inTris, int nTris, const float *modelToClipMatrix,
                                BackfaceWinding bfWinding = MaskedOcclusionCulling::BACKFACE_CW,
                                ClipPlanes clipPlaneMask = MaskedOcclusionCulling::CLIP_PLANE_ALL,
                                const VertexLayout &vtxLayout = VertexLayout(16, 4, 12))
    {
        const Described described(inVtx, inTris, nTris, modelToClipMatrix, bfWinding, clipPlaneMask, vtxLayout);
        int32_t result = MOC_VISIBLE;
        MOC_ThreadpoolTestMesh(mPool, &described.mesh, &result);
        return static_cast<CullingResult>(result);
    }

    /** Flushes, and writes the depth of every pixel; see MaskedOcclusionCulling::ComputePixelDepthBuffer. */
    void ComputePixelDepthBuffer(float *depthData, bool flipY)
    {
        MOC_ThreadpoolComputePixelDepthBuffer(mPool, depthData, flipY ? 1 : 0);
    }

    /**
     * Merges other buffers into the pool's, in order with the calls before and after it, with the result of MergeBuffer
     * for each of them. They must stay unchanged until Flush. Intel's library has no such method.
     */
    void MergeBuffers(const MaskedOcclusionCulling *const *others, unsigned int count)
    {
        do
        {
            for (unsigned int i = 0; others != nullptr && i < count; i++)
                if (others[i] != nullptr)
                    MOC_Flush(others[i]);
        } while (MOC_ThreadpoolMergeBuffers(mPool, others, count) == MOC_STATUS_BUSY);
    }

private:
    /* Points to the layout. */
    struct Described
    {
        MOC_VertexLayout layout;
        MOC_Mesh mesh;

        Described(const float *inVtx, const unsigned int *inTris, int nTris, const float *modelToClipMatrix,
                  BackfaceWinding bfWinding, ClipPlanes clipPlaneMask, const VertexLayout &vtxLayout)
            : layout(MaskedOcclusionCulling::Layout(vtxLayout, modelToClipMatrix)), mesh()
        {
            mesh.size = sizeof(mesh);
            mesh.vertices = inVtx;
            mesh.vertex_count = MOC_UNCHECKED;
            mesh.indices = inTris;
            /* A negative count is refused, because it becomes one above INT32_MAX. */
            mesh.triangle_count = static_cast<uint32_t>(nTris);
            mesh.model_to_clip = modelToClipMatrix;
            mesh.layout = &layout;
            mesh.winding = bfWinding;
            mesh.clip_planes = clipPlaneMask;
        }
        Described(const Described &) = delete;
        Described &operator=(const Described &) = delete;
    };

    MOC_Threadpool *mPool = nullptr;
};

MOC_NAMESPACE_END

} /* extern "C++" */

#include "moc_names_end.h"
