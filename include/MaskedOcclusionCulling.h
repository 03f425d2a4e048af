/*
 * CPU occlusion culling on a masked hierarchical depth buffer: the C++ class.
 *
 * Header-only over the C functions of masked_occlusion_culling.h, so that one compiled library serves every
 * compiler. C++11. Nothing here throws, except that Create and SetResolution rethrow what an allocation callback throws,
 * leaving the object unchanged.
 *
 * Conventions. Clip space is (x, y, w): x right, y up, w away from the eye and positive in view. Depth is 1/w: 0 is
 * infinitely far, larger is nearer. Every instruction set gives the same bits. docs/conventions.md explains matrices,
 * vertex layouts, Direct3D, OpenGL and Vulkan; docs/migrating.md lists every difference from Intel's library, whose
 * header this one replaces. The comment at the top of masked_occlusion_culling.h has more on units, ranges and
 * ownership.
 *
 * Invalid input. Pointers must be null or valid. If an argument is refused (a required pointer is null, a count is
 * negative, a size is outside 1 to 16384, there is no buffer, an enumeration argument has an unknown value), a
 * method without a result does nothing, a query or a draw returns VISIBLE, and a method that returns a number returns 0.
 * Nothing is printed or thrown. GetLastStatus returns the status of the thread's last call; to learn which argument
 * was wrong and why, pass SetMessageCallback a function:
 *
 *     static void Say(void *, int, const char *message) { std::fprintf(stderr, "%s\n", message); }
 *     MaskedOcclusionCulling::SetMessageCallback(Say);
 *     // MOC_RenderTriangles: no buffer: call MOC_SetResolution first
 *
 * Indices are trusted: RenderTriangles, TestTriangles and BinTriangles read every vertex from the lowest to the highest
 * index of the call, whether or not an index refers to it; of vertices of 12 or 16 bytes with y at 4 and w (or z) at 8
 * or 12 they also read everything in between. All of that must be readable. For untrusted indices, the C functions
 * whose names end in Checked take the length of the vertex array and refuse indices beyond it.
 *
 * Threads. TestRect, TestTriangles, BinTriangles and the Get methods may run on several threads at once while nobody
 * draws; RenderTrilist may, in rectangles that do not overlap. Different objects are independent. While a
 * CullingThreadpool draws into an object, any thread may query it; calls that change or copy its buffer first wait for
 * the pool.
 *
 * SPDX-License-Identifier: Apache-2.0 OR MIT
 */
#pragma once

/* For programs that include this header inside extern "C", where templates and overloads are not allowed. */
extern "C++" {

#include <assert.h>
#include <stddef.h>

#include "MaskedOcclusionCullingAllocation.h"
#include "MaskedOcclusionCullingImplementation.h"
#include "masked_occlusion_culling.h"

/*
 * Switches, to be defined before the include or on the command line. They are settings of the objects that Create makes
 * in this translation unit, and may differ between translation units:
 *
 * QUICK_MASK        1: the update rule of "Masked Software Occlusion Culling"; 0: that of "Masked Depth
 *                   Culling for Graphics Hardware"; not defined: three layers, accurate in nearly every scene and order.
 * MOC_FOUR_LAYERS   1: four layers, whatever QUICK_MASK is: culls more where dense geometry is drawn unsorted, but is
 *                   slower and takes 28 bytes per sub-tile of 8x4 pixels. 0 (default): as selected by QUICK_MASK.
 * USE_D3D           1: row 0 is the top of the screen (default); 0: the bottom (OpenGL).
 * USE_AVX512        0: at most AVX2. 1 or not defined: AVX-512 where the processor has it.
 * ENABLE_STATS      1: draws and queries are counted for GetStatistics, which makes draws about a tenth slower.
 *                   0 (default): GetStatistics returns zeros. GetNumDroppedTriangles counts either way.
 * MOC_CHECK_LAYOUT  1 (default without NDEBUG): RenderTriangles, TestTriangles, BinTriangles and RecordRenderTriangles assert
 *                   that a matrix is not combined with VertexLayout(16, 4, 12), the default, whose last offset is then that of
 *                   z: packed x, y, z, w with a matrix is (16, 4, 8). 0 (default with NDEBUG): no assertion. For programs whose
 *                   z really is at 12; the callback of SetMessageCallback may still report it, with MOC_STATUS_OK.
 *                   Unlike the others it should be the same in all translation units, as NDEBUG should: the linker keeps one
 *                   copy of an inline method.
 *
 * QUICK_MASK and USE_AVX512 stay undefined if the program does not define them, whereas Intel's header defines them (1
 * and 0): leaving QUICK_MASK undefined is what selects three layers. A later `#if QUICK_MASK` in the program is then
 * false, and -Wundef reports it. Define both for the previous behaviour.
 *
 * Accepted without effect, because they always hold: PRECISE_COVERAGE (coverage is exact), CLIPPING_PRESERVES_ORDER
 * (the order is preserved), MOC_RECORDER_ENABLE and MOC_RECORDER_ENABLE_PLAYBACK (the recorder is always available,
 * unless the library was built without the feature `recorder`, and costs a load and a branch per call while it is off;
 * FrameRecorder.h reads recordings).
 */
#ifndef USE_D3D
#define USE_D3D 1
#endif
#ifndef PRECISE_COVERAGE
#define PRECISE_COVERAGE 1
#endif
#ifndef CLIPPING_PRESERVES_ORDER
#define CLIPPING_PRESERVES_ORDER 1
#endif
#ifndef ENABLE_STATS
#define ENABLE_STATS 0
#endif
#ifndef MOC_FOUR_LAYERS
#define MOC_FOUR_LAYERS 0
#endif
#ifndef MOC_CHECK_LAYOUT
#ifdef NDEBUG
#define MOC_CHECK_LAYOUT 0
#else
#define MOC_CHECK_LAYOUT 1
#endif
#endif
#ifndef MOC_RECORDER_ENABLE
#define MOC_RECORDER_ENABLE 0
#endif
#ifndef MOC_RECORDER_ENABLE_PLAYBACK
#define MOC_RECORDER_ENABLE_PLAYBACK 0
#endif

/* The switches as the template argument of Create. Bits 0 to 7: MOC_UpdateRule; 8: MOC_YAxis; 9: AVX2 at most;
 * 10: statistics; 11: exceptions. */
#if MOC_FOUR_LAYERS
#define MOC_DETAIL_RULE 3u
#elif !defined(QUICK_MASK)
#define MOC_DETAIL_RULE 0u
#elif QUICK_MASK
#define MOC_DETAIL_RULE 1u
#else
#define MOC_DETAIL_RULE 2u
#endif
#if USE_D3D
#define MOC_DETAIL_Y_AXIS 0u
#else
#define MOC_DETAIL_Y_AXIS 256u
#endif
#ifndef USE_AVX512
#define MOC_DETAIL_CAP 0u
#elif USE_AVX512
#define MOC_DETAIL_CAP 0u
#else
#define MOC_DETAIL_CAP 512u
#endif
#if ENABLE_STATS
#define MOC_DETAIL_STATS 1024u
#else
#define MOC_DETAIL_STATS 0u
#endif
#define MOC_DETAIL_SWITCHES                                                                            \
    (MOC_DETAIL_RULE | MOC_DETAIL_Y_AXIS | MOC_DETAIL_CAP | MOC_DETAIL_STATS |                         \
     (MOC_DETAIL_EXCEPTIONS ? 2048u : 0u))

#include "moc_names.h"

MOC_NAMESPACE_BEGIN

/** A masked hierarchical depth buffer to draw occluders into and to test occludees against. */
class MaskedOcclusionCulling : public MOC_DetailImplementations<void>
{
public:
    /**
     * Allocates `size` bytes aligned to `alignment`; null when there is no memory. If it throws, Create and SetResolution
     * rethrow, provided they are compiled with exceptions; otherwise it must not throw.
     */
    typedef void *(*pfnAlignedAlloc)(size_t alignment, size_t size);
    /** Frees memory allocated by pfnAlignedAlloc. Must not throw. */
    typedef void (*pfnAlignedFree)(void *ptr);

    /** Which triangles are back-facing and skipped, by their winding in normalised device coordinates (y up). */
    enum BackfaceWinding : int
    {
        BACKFACE_NONE = MOC_BACKFACE_NONE,
        BACKFACE_CW   = MOC_BACKFACE_CW,
        BACKFACE_CCW  = MOC_BACKFACE_CCW
    };

    /** The result of a draw or a query. */
    enum CullingResult : int
    {
        VISIBLE     = MOC_VISIBLE,
        OCCLUDED    = MOC_OCCLUDED,
        VIEW_CULLED = MOC_VIEW_CULLED
    };

    /** The frustum planes that a mesh may cross. Only the near plane has an effect. */
    enum ClipPlanes : int
    {
        CLIP_PLANE_NONE   = MOC_CLIP_PLANE_NONE,
        CLIP_PLANE_NEAR   = MOC_CLIP_PLANE_NEAR,
        CLIP_PLANE_LEFT   = MOC_CLIP_PLANE_LEFT,
        CLIP_PLANE_RIGHT  = MOC_CLIP_PLANE_RIGHT,
        CLIP_PLANE_BOTTOM = MOC_CLIP_PLANE_BOTTOM,
        CLIP_PLANE_TOP    = MOC_CLIP_PLANE_TOP,
        CLIP_PLANE_SIDES  = MOC_CLIP_PLANE_SIDES,
        CLIP_PLANE_ALL    = MOC_CLIP_PLANE_ALL
    };

    /** Where the coordinates of a vertex are stored, in bytes. See MOC_VertexLayout for common layouts. */
    struct VertexLayout
    {
        VertexLayout() : mStride(0), mOffsetY(0), mOffsetW(0) {}
        VertexLayout(int stride, int offsetY, int offsetZW) : mStride(stride), mOffsetY(offsetY), mOffsetW(offsetZW) {}

        int mStride;      /**< from one vertex to the next; not negative */
        int mOffsetY;     /**< from x to y */
        union
        {
            int mOffsetZ; /**< from x to z, with a matrix */
            int mOffsetW; /**< from x to w, without one */
        };
    };

    /**
     * A rectangle of pixels: x in multiples of 32, y of 8; a maximum may also be the width or height of the buffer, as
     * is or rounded up to whole tiles.
     */
    struct ScissorRect
    {
        ScissorRect() : mMinX(0), mMinY(0), mMaxX(0), mMaxY(0) {}
        ScissorRect(int minX, int minY, int maxX, int maxY) : mMinX(minX), mMinY(minY), mMaxX(maxX), mMaxY(maxY) {}

        int mMinX; /**< first column */
        int mMinY; /**< first row, in the object's y direction */
        int mMaxX; /**< column after the last */
        int mMaxY; /**< row after the last */
    };

    /** A list of projected triangles in memory that the caller owns. */
    struct TriList
    {
        unsigned int mNumTriangles; /**< number of triangles for which mPtr has room */
        unsigned int mTriIdx;       /**< number of triangles in the list; 0 starts over */
        float *mPtr;                /**< 9 floats per triangle */
    };

    /** Counts since the object was created with ENABLE_STATS 1 (otherwise zeros); the same on every instruction set. */
    struct OcclusionCullingStatistics
    {
        struct
        {
            long long mNumProcessedTriangles;  /**< submitted to be drawn or binned, and those of drawn lists */
            /** Those that are front-facing and whose bounds contain a pixel centre on the screen: counted when they are
             * binned, and again for each list that is drawn. */
            long long mNumRasterizedTriangles;
            /**
             * 32x8 tiles in the bounds of such triangles when they are drawn; for a list, only tiles inside the rectangle.
             */
            long long mNumTilesTraversed;
            long long mNumTilesUpdated;        /**< tiles in which one changed, or could have changed, a sub-tile */
            long long mNumTilesMerged;         /**< tiles in which a reference depth rose */
        } mOccluders;

        struct
        {
            long long mNumProcessedRectangles; /**< rectangles tested */
            long long mNumProcessedTriangles;  /**< triangles submitted to be tested */
            /** Those of them that were compared with the buffer, up to the first that may be visible. */
            long long mNumRasterizedTriangles;
            long long mNumTilesTraversed;      /**< tiles compared with rectangles and such triangles */
        } mOccludees;
    };

    /*
     * Creates an object without a buffer, on the best instruction set that the processor supports and the argument
     * allows. Null if there is no memory, if the library's version does not match this header, or if the library was
     * built without the update rule that the switches select.
     *
     * The template argument carries the switches of the calling translation unit; leave it out. Its default differs
     * between translation units with different switches, which formally violates the one-definition rule; in practice
     * one function is compiled for each value, and the right one is always called.
     */
    template <unsigned int Switches = MOC_DETAIL_SWITCHES>
    static MaskedOcclusionCulling *Create(Implementation RequestedSIMD = AVX512)
    {
        return CreateWith<Switches>(RequestedSIMD, nullptr, nullptr);
    }

    /** The same, but all memory, including that of the object itself, comes from the two callbacks (both or neither null). */
    template <unsigned int Switches = MOC_DETAIL_SWITCHES>
    static MaskedOcclusionCulling *Create(Implementation RequestedSIMD, pfnAlignedAlloc alignedAlloc,
                                          pfnAlignedFree alignedFree)
    {
        return CreateWith<Switches>(RequestedSIMD, alignedAlloc, alignedFree);
    }

    /** The signature of 2016, without an argument for the instruction set. */
    template <unsigned int Switches = MOC_DETAIL_SWITCHES>
    static MaskedOcclusionCulling *Create(pfnAlignedAlloc alignedAlloc, pfnAlignedFree alignedFree)
    {
        return CreateWith<Switches>(AVX512, alignedAlloc, alignedFree);
    }

    /**
     * The MOC_Status of this thread's last call on any object or pool: MOC_STATUS_OK, or why it was refused. It is per thread
     * rather than per object because several threads may query one object, and because there is no object when Create returns
     * null. MOC_StatusText puts it into words.
     */
    static int GetLastStatus() { return MOC_GetLastStatus(); }

    /**
     * Sets the function that receives what was refused and why, for any object or pool in the process, and also reports
     * rectangles with a NaN or with a minimum above its maximum; null (the default): none. It is called on the thread that made
     * the call, and must not throw. See MOC_MessageCallback.
     */
    static void SetMessageCallback(MOC_MessageCallback callback, void *user = nullptr)
    {
        MOC_SetMessageCallback(callback, user);
    }

    /** Frees the object and its buffer. Null is allowed. There is no `delete`. */
    static void Destroy(MaskedOcclusionCulling *moc) { MOC_Destroy(moc); }

    /**
     * Gives the object a cleared buffer, 1 to 16384 pixels wide and high. If the size is refused or there is no memory, it
     * keeps its old buffer. In a buffer smaller than the screen, a gap between occluders that is narrower than a buffer pixel
     * can disappear, and what the screen shows through it is then culled (docs/guide.md).
     */
    MOC_DETAIL_INLINE void SetResolution(unsigned int width, unsigned int height)
    {
        MOC_DetailAllocation<MOC_DETAIL_EXCEPTIONS != 0> allocation;
        Direct([&] { return MOC_SetResolution(this, width, height); });
        allocation.ThrowAgain();
    }

    /** Returns the size of the buffer in pixels; 0 by 0 without one. */
    void GetResolution(unsigned int &width, unsigned int &height) const
    {
        uint32_t w = 0, h = 0;
        MOC_GetResolution(this, &w, &h);
        width = w;
        height = h;
    }

    /**
     * The size of a bin in pixels: that of the buffer divided by the number of bins, rounded down to multiples of 32
     * and 8. The last column and row of bins extend to the buffer's edge. 0 by 0 if a bin would be empty, or without a
     * buffer.
     */
    void ComputeBinWidthHeight(unsigned int nBinsW, unsigned int nBinsH, unsigned int &outBinWidth,
                               unsigned int &outBinHeight) const
    {
        uint32_t w = 0, h = 0;
        MOC_ComputeBinWidthHeight(this, nBinsW, nBinsH, &w, &h);
        outBinWidth = w;
        outBinHeight = h;
    }

    /**
     * Sets the near plane, in clip-space w, for calls with CLIP_PLANE_NEAR. With 0, the default, occludees that reach
     * behind the eye are visible. NaN and infinities are refused.
     */
    void SetNearClipPlane(float nearDist) { MOC_SetNearClipPlane(this, nearDist); }

    /** The near plane, in clip-space w. */
    float GetNearClipPlane() const
    {
        float near_w = 0.0f;
        MOC_GetNearClipPlane(this, &near_w);
        return near_w;
    }

    /** Clears every pixel to infinitely far. */
    void ClearBuffer()
    {
        Direct([&] { return MOC_ClearBuffer(this); });
    }

    /**
     * Merges another buffer into this one: afterwards this one hides what either hid, except for what its few depths
     * cannot represent, and never more. A buffer of another size or y direction is refused.
     */
    void MergeBuffer(MaskedOcclusionCulling *BufferB)
    {
        const MaskedOcclusionCulling *const other = BufferB;
        Direct([&] { return MOC_MergeBuffer(this, other); }, &other, 1);
    }

    /** Merges several buffers into this one: the same result as MergeBuffer for each of them, but faster. */
    void MergeBuffers(const MaskedOcclusionCulling *const *others, unsigned int count)
    {
        Direct([&] { return MOC_MergeBuffers(this, others, count); }, others, count);
    }

    /**
     * Draws occluders: three indices per triangle. Returns VIEW_CULLED if every triangle is outside the view,
     * back-facing or dropped, otherwise VISIBLE.
     *
     * modelToClipMatrix (null: the vertices are in clip space): 16 floats m,
     *     x' = x*m[0] + y*m[4] + z*m[8] + m[12],
     *     y' with m[1] m[5] m[9] m[13], w' with m[3] m[7] m[11] m[15].
     * vtxLayout: the third offset is that of w without a matrix, that of z with one. With a matrix pass (16, 4, 8) or
     * (12, 4, 8), because the default is wrong then.
     */
    CullingResult RenderTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                                  const float *modelToClipMatrix = nullptr, BackfaceWinding bfWinding = BACKFACE_CW,
                                  ClipPlanes clipPlaneMask = CLIP_PLANE_ALL,
                                  const VertexLayout &vtxLayout = VertexLayout(16, 4, 12))
    {
        const MOC_VertexLayout layout = Layout(vtxLayout, modelToClipMatrix);
        int32_t result = MOC_VISIBLE;
        Direct([&] {
            return MOC_RenderTriangles(this, inVtx, inTris, nTris, modelToClipMatrix, bfWinding, clipPlaneMask, &layout,
                                       &result);
        });
        return static_cast<CullingResult>(result);
    }

    /**
     * Tests a rectangle in normalised device coordinates (x/w, y/w, y up) whose nearest point is at wmin, in clip-space
     * w; docs/conventions.md shows how to compute it from a box. Pass wmin = 0 if the object crosses the near plane.
     * Returns VISIBLE if any of it is nearer than what was drawn, or at the same depth; VIEW_CULLED if it is off
     * screen; VISIBLE also for a NaN, for wmin <= 0 and for an empty rectangle (a minimum above its maximum).
     */
    CullingResult TestRect(float xmin, float ymin, float xmax, float ymax, float wmin) const
    {
        int32_t result = MOC_VISIBLE;
        MOC_TestRect(this, xmin, ymin, xmax, ymax, wmin, &result);
        return static_cast<CullingResult>(result);
    }

    /**
     * Tests occludees. Returns VISIBLE if any part of them is nearer than what was drawn, or at the same depth;
     * VIEW_CULLED if no front-facing triangle touches a pixel, or OCCLUDED if all the pixels around such triangles are
     * hidden. The arguments are those of RenderTriangles: with a matrix (x' = x*m[0] + y*m[4] + z*m[8] + m[12]) the
     * third offset is that of z: pass (16, 4, 8) or (12, 4, 8). The answer is for the triangles, not for what they
     * enclose: treat a box that crosses the near plane or contains the eye as visible.
     */
    CullingResult TestTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                                const float *modelToClipMatrix = nullptr, BackfaceWinding bfWinding = BACKFACE_CW,
                                ClipPlanes clipPlaneMask = CLIP_PLANE_ALL,
                                const VertexLayout &vtxLayout = VertexLayout(16, 4, 12)) const
    {
        const MOC_VertexLayout layout = Layout(vtxLayout, modelToClipMatrix);
        int32_t result = MOC_VISIBLE;
        MOC_TestTriangles(this, inVtx, inTris, nTris, modelToClipMatrix, bfWinding, clipPlaneMask, &layout, &result);
        return static_cast<CullingResult>(result);
    }

    /**
     * Appends each triangle that may be drawn to the list of every bin that it overlaps; there are nBinsW * nBinsH
     * lists, row by row. A full list (mTriIdx equals mNumTriangles) drops further triangles, so less is hidden. The
     * other arguments are those of RenderTriangles: with a matrix (x' = x*m[0] + y*m[4] + z*m[8] + m[12]) the third
     * offset is that of z: pass (16, 4, 8) or (12, 4, 8).
     */
    void BinTriangles(const float *inVtx, const unsigned int *inTris, int nTris, TriList *triLists,
                      unsigned int nBinsW, unsigned int nBinsH, const float *modelToClipMatrix = nullptr,
                      BackfaceWinding bfWinding = BACKFACE_CW, ClipPlanes clipPlaneMask = CLIP_PLANE_ALL,
                      const VertexLayout &vtxLayout = VertexLayout(16, 4, 12)) const
    {
        const MOC_VertexLayout layout = Layout(vtxLayout, modelToClipMatrix);
        MOC_BinTriangles(this, inVtx, inTris, nTris, reinterpret_cast<MOC_TriList *>(triLists), nBinsW, nBinsH,
                         modelToClipMatrix, bfWinding, clipPlaneMask, &layout, nullptr);
    }

    /**
     * Draws a list inside the rectangle (null: everywhere). Several threads may do so at once, in rectangles that do
     * not overlap. A rectangle that is not in multiples of 32 and 8 (see ScissorRect) is refused silently, and nothing
     * is drawn; MOC_RenderTrilist returns the status.
     */
    void RenderTrilist(const TriList &triList, const ScissorRect *scissor)
    {
        if (scissor == nullptr)
        {
            Direct([&] { return MOC_RenderTrilist(this, reinterpret_cast<const MOC_TriList *>(&triList), nullptr); });
            return;
        }
        const MOC_ScissorRect rect = {scissor->mMinX, scissor->mMinY, scissor->mMaxX, scissor->mMaxY};
        Direct([&] { return MOC_RenderTrilist(this, reinterpret_cast<const MOC_TriList *>(&triList), &rect); });
    }

    /** Writes the depth (1/w) of width * height pixels, row by row; negative where nothing was drawn. */
    void ComputePixelDepthBuffer(float *depthData, bool flipY) const
    {
        Direct([&] { return MOC_ComputePixelDepthBuffer(this, depthData, flipY ? 1 : 0); });
    }

    /** Returns the counts since the object was created. */
    OcclusionCullingStatistics GetStatistics() const
    {
        MOC_Statistics s = {};
        s.size = sizeof(s);
        MOC_GetStatistics(this, &s);
        OcclusionCullingStatistics stats;
        stats.mOccluders.mNumProcessedTriangles = s.occluders.num_processed_triangles;
        stats.mOccluders.mNumRasterizedTriangles = s.occluders.num_rasterized_triangles;
        stats.mOccluders.mNumTilesTraversed = s.occluders.num_tiles_traversed;
        stats.mOccluders.mNumTilesUpdated = s.occluders.num_tiles_updated;
        stats.mOccluders.mNumTilesMerged = s.occluders.num_tiles_merged;
        stats.mOccludees.mNumProcessedRectangles = s.occludees.num_processed_rectangles;
        stats.mOccludees.mNumProcessedTriangles = s.occludees.num_processed_triangles;
        stats.mOccludees.mNumRasterizedTriangles = s.occludees.num_rasterized_triangles;
        stats.mOccludees.mNumTilesTraversed = s.occludees.num_tiles_traversed;
        return stats;
    }

    /**
     * The number of triangles dropped by draws since the object was created, because of a NaN, an infinity or a
     * distance beyond 2^40; counted whatever ENABLE_STATS is. Intel's library has no such method.
     */
    long long GetNumDroppedTriangles() const
    {
        int64_t dropped = 0;
        MOC_GetDroppedTriangles(this, &dropped);
        return dropped;
    }

    /** The instruction set in use. */
    Implementation GetImplementation() const
    {
        int32_t implementation = MOC_SCALAR;
        MOC_GetImplementation(this, &implementation);
        return static_cast<Implementation>(implementation);
    }

    /** Transforms nVtx vertices by (x, y, z, 1) * mtx and writes them as packed x, y, z, w. */
    static void TransformVertices(const float *mtx, const float *inVtx, float *xfVtx, unsigned int nVtx,
                                  const VertexLayout &vtxLayout = VertexLayout(12, 4, 8))
    {
        const MOC_VertexLayout layout = Layout(vtxLayout, nullptr);
        MOC_TransformVertices(mtx, inVtx, xfVtx, nVtx, &layout);
    }

    /** Returns the callbacks passed to Create, or the library's own if there were none. */
    void GetAllocFreeCallback(pfnAlignedAlloc &allocCallback, pfnAlignedFree &freeCallback) const
    {
        MOC_GetAllocFreeCallback(this, &allocCallback, &freeCallback);
    }

    /**
     * Records clears, draws and queries, with their results, into a file from now on, including those of a thread pool.
     * Returns false if the file cannot be created, if there is no buffer, or if the object is already recording.
     * Changing the near plane or the resolution ends a recording that already contains a call. BinTriangles,
     * RenderTrilist and MergeBuffer are not recorded.
     */
    bool RecorderStart(const char *outputFilePath) const
    {
        return MOC_RecorderStart(this, outputFilePath) == MOC_STATUS_OK;
    }

    /** Ends the recording, if there is one. MOC_RecorderStop reports whether all of it was written. */
    void RecorderStop() const { MOC_RecorderStop(this); }

    /**
     * Records a draw that does not go through RenderTriangles, such as that of a binned mesh. Note that clip planes and
     * winding are in the opposite order to RenderTriangles.
     */
    void RecordRenderTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                               const float *modelToClipMatrix = nullptr, ClipPlanes clipPlaneMask = CLIP_PLANE_ALL,
                               BackfaceWinding bfWinding = BACKFACE_CW,
                               const VertexLayout &vtxLayout = VertexLayout(16, 4, 12),
                               CullingResult cullingResult = static_cast<CullingResult>(MOC_RESULT_UNKNOWN)) const
    {
        const MOC_VertexLayout layout = Layout(vtxLayout, modelToClipMatrix);
        MOC_RecordRenderTriangles(this, inVtx, inTris, nTris, modelToClipMatrix, bfWinding, clipPlaneMask, &layout,
                                  cullingResult);
    }

    /* Objects are created and freed by the library only; to C++ this is an opaque class. */
    MaskedOcclusionCulling() = delete;
    ~MaskedOcclusionCulling() = delete;
    MaskedOcclusionCulling(const MaskedOcclusionCulling &) = delete;
    MaskedOcclusionCulling &operator=(const MaskedOcclusionCulling &) = delete;

private:
    friend class CullingThreadpool;

    /* For calls that change or copy the buffer: first waits for a pool's work in flight on this object. */
    template <class Call>
    void Direct(Call call, const MaskedOcclusionCulling *const *others = nullptr, unsigned int count = 0) const
    {
        do
        {
            MOC_Flush(this);
            for (unsigned int i = 0; others != nullptr && i < count; i++)
                if (others[i] != nullptr)
                    MOC_Flush(others[i]);
        } while (call() == MOC_STATUS_BUSY);
    }

    template <unsigned int Switches>
    static MaskedOcclusionCulling *CreateWith(Implementation implementation, pfnAlignedAlloc alignedAlloc,
                                              pfnAlignedFree alignedFree)
    {
        const unsigned int library = MOC_GetAbiVersion(), header = MOC_ABI_VERSION;
        const bool stable = header >= 1000;
        if (stable ? library / 1000 != header / 1000 || library < header : library != header)
            return nullptr;
        MOC_Settings settings = {};
        settings.size = sizeof(settings);
        MOC_DefaultSettings(&settings);
        settings.implementation = (Switches & 512u) != 0 && implementation == AVX512 ? AVX2 : implementation;
        settings.update_rule = static_cast<int32_t>(Switches & 255u);
        settings.y_axis = (Switches & 256u) != 0 ? MOC_Y_AXIS_UP : MOC_Y_AXIS_DOWN;
        settings.statistics = (Switches & 1024u) != 0 ? 1 : 0;
        settings.alloc = alignedAlloc;
        settings.free = alignedFree;
        typedef MOC_DetailAllocation<(Switches & 2048u) != 0> Allocation;
        settings.call_alloc = Allocation::Caller();
        Allocation allocation;
        MaskedOcclusionCulling *moc = nullptr;
        MOC_Create(&settings, &moc);
        allocation.ThrowAgain();
        return moc;
    }

    static MOC_VertexLayout Layout(const VertexLayout &layout, const float *modelToClipMatrix)
    {
#if MOC_CHECK_LAYOUT
        assert((modelToClipMatrix == nullptr || layout.mStride != 16 || layout.mOffsetY != 4 || layout.mOffsetZ != 12) &&
               "with a matrix the last offset of the vertex layout names z: x, y, z, w packed is VertexLayout(16, 4, 8)");
#else
        (void)modelToClipMatrix;
#endif
        const MOC_VertexLayout plain = {layout.mStride, layout.mOffsetY, layout.mOffsetW};
        return plain;
    }
};

static_assert(sizeof(MaskedOcclusionCulling::TriList) == sizeof(MOC_TriList) &&
                  offsetof(MaskedOcclusionCulling::TriList, mTriIdx) == offsetof(MOC_TriList, count) &&
                  offsetof(MaskedOcclusionCulling::TriList, mPtr) == offsetof(MOC_TriList, data),
              "a TriList is passed to the C functions as it is");

static_assert(sizeof(MaskedOcclusionCulling::OcclusionCullingStatistics) == 72, "programs copy the statistics by offset");

MOC_NAMESPACE_END

} /* extern "C++" */

#include "moc_names_end.h"
