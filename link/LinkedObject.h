/*
 * What the files of this folder share: the C functions, beside a class of the same name as their objects, and the way
 * from the one to the other. For those files only; include the program's MaskedOcclusionCulling.h first.
 *
 * SPDX-License-Identifier: Apache-2.0 OR MIT
 */
#pragma once

// The C header calls its opaque objects as the class is called, which here is something else.
#define MaskedOcclusionCulling MOC_LinkedObject
#include "../include/MaskedOcclusionCullingAllocation.h"
#undef MaskedOcclusionCulling

// To the end of the including file, MOC_Create stands for the name with the prefix.
#include "../include/moc_names.h"

namespace moc_link
{

/** The library's object in one that MaskedOcclusionCulling::Create made; null for null. */
MOC_LinkedObject *ObjectOf(const MaskedOcclusionCulling *moc);

/** See MaskedOcclusionCullingAllocation.h. */
typedef MOC_DetailAllocation<MOC_DETAIL_EXCEPTIONS != 0> Allocation;

/** Whether the library that was linked is of the version of the C header. */
inline bool LibraryFits()
{
    const unsigned int library = MOC_GetAbiVersion(), header = MOC_ABI_VERSION;
    const bool stable = header >= 1000;
    return stable ? library / 1000 == header / 1000 && library >= header : library == header;
}

inline MOC_VertexLayout Layout(const MaskedOcclusionCulling::VertexLayout &layout)
{
    const MOC_VertexLayout plain = {layout.mStride, layout.mOffsetY, layout.mOffsetW};
    return plain;
}

} // namespace moc_link
