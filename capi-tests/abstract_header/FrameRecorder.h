// The recorder's functions for the class in this folder; abstract_recorder.cpp counts their calls.
#pragma once

#include "MaskedOcclusionCulling.h"

class FrameRecorder
{
public:
    int mClears = 0, mDraws = 0, mRects = 0, mMeshes = 0;

    void RecordClearBuffer() { mClears++; }
    void RecordTestRect(MaskedOcclusionCulling::CullingResult, float, float, float, float, float) { mRects++; }
    void RecordTestTriangles(MaskedOcclusionCulling::CullingResult, const float *, const unsigned int *, int,
                             const float *, MaskedOcclusionCulling::ClipPlanes, MaskedOcclusionCulling::BackfaceWinding,
                             const MaskedOcclusionCulling::VertexLayout &)
    {
        mMeshes++;
    }
};
