// A class as in an engine that cannot change its headers: the same public methods as this library's, but virtual, in
// the order of Intel's header. This is not that header; it takes its place in the tests of link/.
#pragma once

#ifndef QUICK_MASK
#define QUICK_MASK 1
#endif
#ifndef USE_D3D
#define USE_D3D 1
#endif
#ifndef PRECISE_COVERAGE
#define PRECISE_COVERAGE 1
#endif
#ifndef USE_AVX512
#define USE_AVX512 0
#endif
#ifndef ENABLE_STATS
#define ENABLE_STATS 0
#endif
#ifndef MOC_RECORDER_ENABLE
#define MOC_RECORDER_ENABLE 0
#endif

#if MOC_RECORDER_ENABLE
#include <mutex>
class FrameRecorder;
#endif

class MaskedOcclusionCulling
{
public:
    typedef void *(*pfnAlignedAlloc)(size_t alignment, size_t size);
    typedef void (*pfnAlignedFree)(void *ptr);

    enum Implementation { SSE2, SSE41, AVX2, AVX512 };
    enum BackfaceWinding { BACKFACE_NONE, BACKFACE_CW, BACKFACE_CCW };
    enum CullingResult { VISIBLE = 0, OCCLUDED = 1, VIEW_CULLED = 3 };
    enum ClipPlanes {
        CLIP_PLANE_NONE = 0,
        CLIP_PLANE_NEAR = 1,
        CLIP_PLANE_LEFT = 2,
        CLIP_PLANE_RIGHT = 4,
        CLIP_PLANE_BOTTOM = 8,
        CLIP_PLANE_TOP = 16,
        CLIP_PLANE_SIDES = 30,
        CLIP_PLANE_ALL = 31
    };

    struct VertexLayout
    {
        VertexLayout() {}
        VertexLayout(int stride, int offsetY, int offsetZW) : mStride(stride), mOffsetY(offsetY), mOffsetW(offsetZW) {}
        int mStride, mOffsetY;
        union
        {
            int mOffsetZ, mOffsetW;
        };
    };

    struct ScissorRect
    {
        ScissorRect() {}
        ScissorRect(int minX, int minY, int maxX, int maxY) : mMinX(minX), mMinY(minY), mMaxX(maxX), mMaxY(maxY) {}
        int mMinX, mMinY, mMaxX, mMaxY;
    };

    struct TriList
    {
        unsigned int mNumTriangles, mTriIdx;
        float *mPtr;
    };

    struct OcclusionCullingStatistics
    {
        struct
        {
            long long mNumProcessedTriangles, mNumRasterizedTriangles, mNumTilesTraversed, mNumTilesUpdated,
                mNumTilesMerged;
        } mOccluders;
        struct
        {
            long long mNumProcessedRectangles, mNumProcessedTriangles, mNumRasterizedTriangles, mNumTilesTraversed;
        } mOccludees;
    };

    static MaskedOcclusionCulling *Create(Implementation RequestedSIMD = AVX512);
    static MaskedOcclusionCulling *Create(Implementation RequestedSIMD, pfnAlignedAlloc alignedAlloc,
                                          pfnAlignedFree alignedFree);
    static void Destroy(MaskedOcclusionCulling *moc);

    virtual void SetResolution(unsigned int width, unsigned int height) = 0;
    virtual void GetResolution(unsigned int &width, unsigned int &height) const = 0;
    virtual void ComputeBinWidthHeight(unsigned int nBinsW, unsigned int nBinsH, unsigned int &outBinWidth,
                                       unsigned int &outBinHeight) = 0;
    virtual void SetNearClipPlane(float nearDist) = 0;
    virtual float GetNearClipPlane() const = 0;
    virtual void ClearBuffer() = 0;
    virtual void MergeBuffer(MaskedOcclusionCulling *BufferB) = 0;
    virtual CullingResult RenderTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                                          const float *modelToClipMatrix = nullptr,
                                          BackfaceWinding bfWinding = BACKFACE_CW,
                                          ClipPlanes clipPlaneMask = CLIP_PLANE_ALL,
                                          const VertexLayout &vtxLayout = VertexLayout(16, 4, 12)) = 0;
    virtual CullingResult TestRect(float xmin, float ymin, float xmax, float ymax, float wmin) const = 0;
    virtual CullingResult TestTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                                        const float *modelToClipMatrix = nullptr,
                                        BackfaceWinding bfWinding = BACKFACE_CW,
                                        ClipPlanes clipPlaneMask = CLIP_PLANE_ALL,
                                        const VertexLayout &vtxLayout = VertexLayout(16, 4, 12)) = 0;
    virtual void BinTriangles(const float *inVtx, const unsigned int *inTris, int nTris, TriList *triLists,
                              unsigned int nBinsW, unsigned int nBinsH, const float *modelToClipMatrix = nullptr,
                              BackfaceWinding bfWinding = BACKFACE_CW, ClipPlanes clipPlaneMask = CLIP_PLANE_ALL,
                              const VertexLayout &vtxLayout = VertexLayout(16, 4, 12)) = 0;
    virtual void RenderTrilist(const TriList &triList, const ScissorRect *scissor) = 0;
    virtual void ComputePixelDepthBuffer(float *depthData, bool flipY) = 0;
    virtual OcclusionCullingStatistics GetStatistics() = 0;
    virtual Implementation GetImplementation() = 0;

    static void TransformVertices(const float *mtx, const float *inVtx, float *xfVtx, unsigned int nVtx,
                                  const VertexLayout &vtxLayout = VertexLayout(12, 4, 8));

    void GetAllocFreeCallback(pfnAlignedAlloc &allocCallback, pfnAlignedFree &freeCallback)
    {
        allocCallback = mAlignedAllocCallback;
        freeCallback = mAlignedFreeCallback;
    }

#if MOC_RECORDER_ENABLE
    bool RecorderStart(const char *outputFilePath) const;
    void RecorderStop() const;
    void RecordRenderTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                               const float *modelToClipMatrix = nullptr, ClipPlanes clipPlaneMask = CLIP_PLANE_ALL,
                               BackfaceWinding bfWinding = BACKFACE_CW,
                               const VertexLayout &vtxLayout = VertexLayout(16, 4, 12),
                               CullingResult cullingResult = static_cast<CullingResult>(-1));
#endif

protected:
    pfnAlignedAlloc mAlignedAllocCallback;
    pfnAlignedFree mAlignedFreeCallback;
    mutable OcclusionCullingStatistics mStats;
#if MOC_RECORDER_ENABLE
    mutable FrameRecorder *mRecorder;
    mutable std::mutex mRecorderMutex;
#endif

    virtual ~MaskedOcclusionCulling() {}
};
