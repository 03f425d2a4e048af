/*
 * CPU occlusion culling on a masked hierarchical depth buffer: recorded frames, for playback.
 *
 * MaskedOcclusionCulling::RecorderStart and RecorderStop write an object's calls and their results to a file;
 * FrameRecording::Load reads it. Both are available whatever MOC_RECORDER_ENABLE and
 * MOC_RECORDER_ENABLE_PLAYBACK are, unless the library was built without the feature `recorder`, and cost a load and a
 * branch per call while nothing is recorded. The file format is that of Intel's library; docs/recordings.md specifies it
 * byte by byte.
 *
 * Header-only over the C functions of masked_occlusion_culling.h. A library built without the feature `recorder` lacks
 * those of the recorder, which shows when linking. C++11. Load throws only what std::vector throws when there is no
 * memory.
 *
 * SPDX-License-Identifier: Apache-2.0 OR MIT
 */
#pragma once

/* For programs that include this header inside extern "C". */
extern "C++" {

#include <string.h>

#include <utility>
#include <vector>

#include "MaskedOcclusionCulling.h"

#include "moc_names.h"

MOC_NAMESPACE_BEGIN

/** One or more recorded frames. */
struct FrameRecording
{
    /** Triangles that were drawn or tested. */
    struct TrianglesEntry
    {
        MaskedOcclusionCulling::CullingResult mCullingResult; /**< -1 if not known */
        std::vector<float> mVertices;                         /**< in the layout mVertexLayout */
        std::vector<unsigned int> mTriangles;                 /**< three indices per triangle */
        float mModelToClipMatrix[16];                         /**< zeros if there is none */
        MaskedOcclusionCulling::BackfaceWinding mbfWinding;
        MaskedOcclusionCulling::VertexLayout mVertexLayout;
        MaskedOcclusionCulling::ClipPlanes mClipPlaneMask;
        bool mHasModelToClipMatrix;
        bool mHasScissorRect; /**< always false: the file format has no scissor rectangle */
    };

    /** A rectangle that was tested. */
    struct RectEntry
    {
        MaskedOcclusionCulling::CullingResult mCullingResult; /**< -1 if not known */
        float mXMin;
        float mYMin;
        float mXMax;
        float mYMax;
        float mWMin;
    };

    /**
     * The calls, in order: 0 RenderTriangles and 2 TestTriangles, with an index into mTriangleEntries; 1 TestRect, into
     * mRectEntries; 3 ClearBuffer, with -1.
     */
    std::vector<std::pair<char, int> > mPlaybackOrder;
    std::vector<TrianglesEntry> mTriangleEntries;
    std::vector<RectEntry> mRectEntries;

    float mNearClipPlane = 0.0f;
    unsigned int mResolutionWidth = 0;
    unsigned int mResolutionHeight = 0;

    /** Removes everything. */
    void Reset() { *this = FrameRecording(); }

    /**
     * Reads a file. Returns false, and an empty recording, if it cannot be read, is not a recording, or is truncated or
     * corrupt.
     */
    static bool Load(const char *inputFilePath, FrameRecording &outRecording)
    {
        outRecording.Reset();
        MOC_Recording *recording = nullptr;
        if (MOC_RecordingLoad(inputFilePath, &recording) != MOC_STATUS_OK)
            return false;
        /* Frees the recording even if a vector throws. */
        const Guard guard = {recording};
        MOC_RecordingInfo info = {};
        info.size = sizeof(info);
        MOC_RecordingGetInfo(recording, &info);
        outRecording.mNearClipPlane = info.near_clip_plane;
        outRecording.mResolutionWidth = info.width;
        outRecording.mResolutionHeight = info.height;
        outRecording.mPlaybackOrder.reserve(info.num_calls);
        for (uint32_t i = 0; i < info.num_calls; ++i)
        {
            MOC_RecordedCall call = {};
            call.size = sizeof(call);
            MOC_RecordingGetCall(recording, i, &call);
            outRecording.Append(call);
        }
        return true;
    }

private:
    struct Guard
    {
        MOC_Recording *recording;
        ~Guard() { MOC_RecordingDestroy(recording); }
    };

    void Append(const MOC_RecordedCall &call)
    {
        const MaskedOcclusionCulling::CullingResult result =
            static_cast<MaskedOcclusionCulling::CullingResult>(call.result);
        int index = -1;
        if (call.kind == MOC_RECORDED_TEST_RECT)
        {
            index = static_cast<int>(mRectEntries.size());
            const RectEntry entry = {result, call.rect[0], call.rect[1], call.rect[2], call.rect[3], call.rect[4]};
            mRectEntries.push_back(entry);
        }
        else if (call.kind != MOC_RECORDED_CLEAR_BUFFER)
        {
            index = static_cast<int>(mTriangleEntries.size());
            mTriangleEntries.push_back(TrianglesEntry());
            TrianglesEntry &entry = mTriangleEntries.back();
            const MOC_Mesh &mesh = *call.mesh;
            const unsigned int *const indices = static_cast<const unsigned int *>(mesh.indices);
            entry.mCullingResult = result;
            entry.mVertices.assign(mesh.vertices, mesh.vertices + call.vertex_floats);
            entry.mTriangles.assign(indices, indices + 3 * static_cast<size_t>(mesh.triangle_count));
            entry.mHasModelToClipMatrix = mesh.model_to_clip != nullptr;
            if (entry.mHasModelToClipMatrix)
                memcpy(entry.mModelToClipMatrix, mesh.model_to_clip, sizeof(entry.mModelToClipMatrix));
            entry.mbfWinding = static_cast<MaskedOcclusionCulling::BackfaceWinding>(mesh.winding);
            entry.mVertexLayout = MaskedOcclusionCulling::VertexLayout(mesh.layout->stride, mesh.layout->offset_y,
                                                                       mesh.layout->offset_zw);
            entry.mClipPlaneMask = static_cast<MaskedOcclusionCulling::ClipPlanes>(mesh.clip_planes);
            entry.mHasScissorRect = false;
        }
        mPlaybackOrder.push_back(std::pair<char, int>(static_cast<char>(call.kind), index));
    }
};

MOC_NAMESPACE_END

} /* extern "C++" */

#include "moc_names_end.h"
