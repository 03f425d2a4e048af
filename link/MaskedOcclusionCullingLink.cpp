/*
 * Intel's class implemented with this library, for programs whose MaskedOcclusionCulling.h cannot change: object files
 * compiled against that header link with this file and run, without being recompiled. Programs that can change their
 * include path do not need it; see include/MaskedOcclusionCulling.h.
 *
 * Compile it instead of MaskedOcclusionCulling.cpp, MaskedOcclusionCullingAVX2.cpp and
 * MaskedOcclusionCullingAVX512.cpp, with the program's own header in the include path, and with the switches that those
 * files were compiled with: they decide, as before, for the whole program. This repository's include folder need not be
 * in the include path, and must not come before the program's. Then link the library.
 *
 *     c++ -I engine/moc -c link/MaskedOcclusionCullingLink.cpp link/CullingThreadpoolLink.cpp
 *
 * CullingThreadpool.cpp is replaced by CullingThreadpoolLink.cpp, which explains why. FrameRecorder.cpp stays: with
 * MOC_RECORDER_ENABLE 1 this file calls it; otherwise it is empty.
 *
 * QUICK_MASK        1: the update rule of "Masked Software Occlusion Culling"; 0: that of "Masked Depth Culling for
 *                   Graphics Hardware"; not defined: three layers, accurate in nearly every scene and order, unless
 *                   the header was edited to 0.
 * MOC_FOUR_LAYERS   1: four layers, regardless of QUICK_MASK. Intel's header does not have this switch.
 * USE_AVX512        0: at most AVX2. 1 or not defined: AVX-512 if the processor has it.
 * USE_D3D, ENABLE_STATS and MOC_RECORDER_ENABLE work as in the header. PRECISE_COVERAGE is ignored: coverage is exact.
 *
 * GetImplementation returns SSE2 for sets that the header does not name: scalar code, NEON and simd128.
 *
 * C++11; nothing here needs run-time type information, and the only exceptions are those of allocation callbacks, rethrown.
 *
 * SPDX-License-Identifier: Apache-2.0 OR MIT
 */

// The program's header defines the first two by default, so whether the program defined them can only be seen before
// it.
#ifdef QUICK_MASK
#define MOC_LINK_RULE_IS_CHOSEN 1
#else
#define MOC_LINK_RULE_IS_CHOSEN 0
#endif
#ifndef MOC_FOUR_LAYERS
#define MOC_FOUR_LAYERS 0
#endif
#ifdef USE_AVX512
#define MOC_LINK_CAP (!(USE_AVX512))
#else
#define MOC_LINK_CAP 0
#endif

#include <stddef.h>

#include <new>
#include <type_traits>

// That header does not include one that declares size_t, so it comes after.
#include "MaskedOcclusionCulling.h"

#ifdef MOC_DETAIL_SWITCHES
#error "This found the header of this repository, which needs no such file: put the program's own first in the include path"
#endif

#if MOC_RECORDER_ENABLE
#include "FrameRecorder.h"
#endif

#include "LinkedObject.h"

namespace
{

static_assert(std::is_abstract<MaskedOcclusionCulling>::value, "the header of a class whose methods are virtual");

// The alignment of memory from the callbacks: that of every buffer, so every callback supports it.
const size_t ALIGNMENT = 64;

// The class of the objects that Create returns. The compiler takes the order of the methods from the header.
class Linked final : public MaskedOcclusionCulling
{
public:
    Linked(MOC_LinkedObject *object, pfnAlignedAlloc alignedAlloc, pfnAlignedFree alignedFree) : mObject(object)
    {
        mAlignedAllocCallback = alignedAlloc;
        mAlignedFreeCallback = alignedFree;
        mStats = OcclusionCullingStatistics();
#if MOC_RECORDER_ENABLE
        mRecorder = nullptr;
#endif
    }

    ~Linked() override
    {
#if MOC_RECORDER_ENABLE
        // Must not be called while nothing is recorded.
        if (mRecorder != nullptr)
            RecorderStop();
#endif
        MOC_Destroy(mObject);
    }

    static MOC_LinkedObject *ObjectOf(const MaskedOcclusionCulling *moc)
    {
        return moc != nullptr ? static_cast<const Linked *>(moc)->mObject : nullptr;
    }

    static void Delete(MaskedOcclusionCulling *moc)
    {
        Linked *linked = static_cast<Linked *>(moc);
        const pfnAlignedFree alignedFree = linked->mAlignedFreeCallback;
        linked->~Linked();
        alignedFree(linked);
    }

    void SetResolution(unsigned int width, unsigned int height) override
    {
        moc_link::Allocation allocation;
        Direct([&] { return MOC_SetResolution(mObject, width, height); });
        allocation.ThrowAgain();
    }

    void GetResolution(unsigned int &width, unsigned int &height) const override
    {
        uint32_t w = 0, h = 0;
        MOC_GetResolution(mObject, &w, &h);
        width = w;
        height = h;
    }

    void ComputeBinWidthHeight(unsigned int nBinsW, unsigned int nBinsH, unsigned int &outBinWidth,
                               unsigned int &outBinHeight) override
    {
        uint32_t w = 0, h = 0;
        MOC_ComputeBinWidthHeight(mObject, nBinsW, nBinsH, &w, &h);
        outBinWidth = w;
        outBinHeight = h;
    }

    void SetNearClipPlane(float nearDist) override { MOC_SetNearClipPlane(mObject, nearDist); }

    float GetNearClipPlane() const override
    {
        float near_w = 0.0f;
        MOC_GetNearClipPlane(mObject, &near_w);
        return near_w;
    }

    void ClearBuffer() override
    {
#if MOC_RECORDER_ENABLE
        {
            std::lock_guard<std::mutex> lock(mRecorderMutex);
            if (mRecorder != nullptr)
                mRecorder->RecordClearBuffer();
        }
#endif
        Direct([&] { return MOC_ClearBuffer(mObject); });
    }

    void MergeBuffer(MaskedOcclusionCulling *BufferB) override
    {
        const MOC_LinkedObject *const other = ObjectOf(BufferB);
        Direct([&] { return MOC_MergeBuffer(mObject, other); }, other);
    }

    CullingResult RenderTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                                  const float *modelToClipMatrix, BackfaceWinding bfWinding, ClipPlanes clipPlaneMask,
                                  const VertexLayout &vtxLayout) override
    {
        const MOC_VertexLayout layout = moc_link::Layout(vtxLayout);
        int32_t result = MOC_VISIBLE;
        Direct([&] {
            return MOC_RenderTriangles(mObject, inVtx, inTris, nTris, modelToClipMatrix, bfWinding, clipPlaneMask, &layout,
                                       &result);
        });
#if MOC_RECORDER_ENABLE
        RecordRenderTriangles(inVtx, inTris, nTris, modelToClipMatrix, clipPlaneMask, bfWinding, vtxLayout,
                              static_cast<CullingResult>(result));
#endif
        return static_cast<CullingResult>(result);
    }

    CullingResult TestRect(float xmin, float ymin, float xmax, float ymax, float wmin) const override
    {
        int32_t result = MOC_VISIBLE;
        MOC_TestRect(mObject, xmin, ymin, xmax, ymax, wmin, &result);
#if MOC_RECORDER_ENABLE
        std::lock_guard<std::mutex> lock(mRecorderMutex);
        if (mRecorder != nullptr)
            mRecorder->RecordTestRect(static_cast<CullingResult>(result), xmin, ymin, xmax, ymax, wmin);
#endif
        return static_cast<CullingResult>(result);
    }

    CullingResult TestTriangles(const float *inVtx, const unsigned int *inTris, int nTris,
                                const float *modelToClipMatrix, BackfaceWinding bfWinding, ClipPlanes clipPlaneMask,
                                const VertexLayout &vtxLayout) override
    {
        const MOC_VertexLayout layout = moc_link::Layout(vtxLayout);
        int32_t result = MOC_VISIBLE;
        MOC_TestTriangles(mObject, inVtx, inTris, nTris, modelToClipMatrix, bfWinding, clipPlaneMask, &layout, &result);
#if MOC_RECORDER_ENABLE
        std::lock_guard<std::mutex> lock(mRecorderMutex);
        if (mRecorder != nullptr)
            mRecorder->RecordTestTriangles(static_cast<CullingResult>(result), inVtx, inTris, nTris, modelToClipMatrix,
                                           clipPlaneMask, bfWinding, vtxLayout);
#endif
        return static_cast<CullingResult>(result);
    }

    void BinTriangles(const float *inVtx, const unsigned int *inTris, int nTris, TriList *triLists, unsigned int nBinsW,
                      unsigned int nBinsH, const float *modelToClipMatrix, BackfaceWinding bfWinding,
                      ClipPlanes clipPlaneMask, const VertexLayout &vtxLayout) override
    {
        const MOC_VertexLayout layout = moc_link::Layout(vtxLayout);
        MOC_BinTriangles(mObject, inVtx, inTris, nTris, reinterpret_cast<MOC_TriList *>(triLists), nBinsW, nBinsH,
                         modelToClipMatrix, bfWinding, clipPlaneMask, &layout, nullptr);
    }

    void RenderTrilist(const TriList &triList, const ScissorRect *scissor) override
    {
        const MOC_TriList *list = reinterpret_cast<const MOC_TriList *>(&triList);
        if (scissor == nullptr)
        {
            Direct([&] { return MOC_RenderTrilist(mObject, list, nullptr); });
            return;
        }
        const MOC_ScissorRect rect = {scissor->mMinX, scissor->mMinY, scissor->mMaxX, scissor->mMaxY};
        Direct([&] { return MOC_RenderTrilist(mObject, list, &rect); });
    }

    void ComputePixelDepthBuffer(float *depthData, bool flipY) override
    {
        Direct([&] { return MOC_ComputePixelDepthBuffer(mObject, depthData, flipY ? 1 : 0); });
    }

    OcclusionCullingStatistics GetStatistics() override
    {
        MOC_Statistics s = {};
        s.size = sizeof(s);
        MOC_GetStatistics(mObject, &s);
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

    Implementation GetImplementation() override
    {
        int32_t implementation = MOC_SSE2;
        MOC_GetImplementation(mObject, &implementation);
        const bool named = implementation >= MOC_SSE2 && implementation <= MOC_AVX512;
        return named ? static_cast<Implementation>(implementation) : SSE2;
    }

private:
    // A call that changes or copies the buffer: first waits for the work that a pool has in flight for it.
    template <class Call> void Direct(Call call, const MOC_LinkedObject *other = nullptr) const
    {
        do
        {
            MOC_Flush(mObject);
            if (other != nullptr)
                MOC_Flush(other);
        } while (call() == MOC_STATUS_BUSY);
    }

    MOC_LinkedObject *mObject;
};

static_assert(alignof(Linked) <= ALIGNMENT, "the callbacks are asked for a higher alignment");

static_assert(sizeof(MaskedOcclusionCulling::TriList) == sizeof(MOC_TriList) &&
                  offsetof(MaskedOcclusionCulling::TriList, mTriIdx) == offsetof(MOC_TriList, count) &&
                  offsetof(MaskedOcclusionCulling::TriList, mPtr) == offsetof(MOC_TriList, data),
              "a TriList is passed to the C functions as it is");

int32_t UpdateRule()
{
#if MOC_FOUR_LAYERS
    return MOC_UPDATE_RULE_FOUR_LAYER;
#elif !QUICK_MASK
    return MOC_UPDATE_RULE_ACCURATE;
#elif MOC_LINK_RULE_IS_CHOSEN
    return MOC_UPDATE_RULE_QUICK;
#else
    return MOC_UPDATE_RULE_THREE_LAYER;
#endif
}

} // namespace

MOC_LinkedObject *moc_link::ObjectOf(const MaskedOcclusionCulling *moc)
{
    return Linked::ObjectOf(moc);
}

MaskedOcclusionCulling *MaskedOcclusionCulling::Create(Implementation RequestedSIMD)
{
    return Create(RequestedSIMD, nullptr, nullptr);
}

MaskedOcclusionCulling *MaskedOcclusionCulling::Create(Implementation RequestedSIMD, pfnAlignedAlloc alignedAlloc,
                                                       pfnAlignedFree alignedFree)
{
    if (!moc_link::LibraryFits())
        return nullptr;
    MOC_Settings settings = {};
    settings.size = sizeof(settings);
    MOC_DefaultSettings(&settings);
    settings.implementation = MOC_LINK_CAP && RequestedSIMD == AVX512 ? AVX2 : RequestedSIMD;
    settings.update_rule = UpdateRule();
    settings.y_axis = USE_D3D ? MOC_Y_AXIS_DOWN : MOC_Y_AXIS_UP;
    settings.statistics = ENABLE_STATS ? 1 : 0;
    settings.alloc = alignedAlloc;
    settings.free = alignedFree;
    settings.call_alloc = moc_link::Allocation::Caller();
    moc_link::Allocation allocation;
    MOC_LinkedObject *object = nullptr;
    if (MOC_Create(&settings, &object) != MOC_STATUS_OK)
    {
        allocation.ThrowAgain();
        return nullptr;
    }

    // The wrapping object is allocated with the same callbacks as the object; without any, with the library's
    // allocator.
    MOC_GetAllocFreeCallback(object, &alignedAlloc, &alignedFree);
    void *memory = moc_link::Allocation::Call(alignedAlloc, ALIGNMENT, (sizeof(Linked) + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT);
    if (memory != nullptr && reinterpret_cast<uintptr_t>(memory) % alignof(Linked) == 0)
        return new (memory) Linked(object, alignedAlloc, alignedFree);
    if (memory != nullptr)
        alignedFree(memory);
    MOC_Destroy(object);
    allocation.ThrowAgain();
    return nullptr;
}

void MaskedOcclusionCulling::Destroy(MaskedOcclusionCulling *moc)
{
    if (moc != nullptr)
        Linked::Delete(moc);
}

void MaskedOcclusionCulling::TransformVertices(const float *mtx, const float *inVtx, float *xfVtx, unsigned int nVtx,
                                               const VertexLayout &vtxLayout)
{
    const MOC_VertexLayout layout = moc_link::Layout(vtxLayout);
    MOC_TransformVertices(mtx, inVtx, xfVtx, nVtx, &layout);
}
