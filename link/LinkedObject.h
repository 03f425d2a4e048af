/*
 * Shared by the files of this folder: the C functions, alongside a class with the same name as their opaque type, and
 * the conversion between the two. For those files only; include the program's MaskedOcclusionCulling.h first.
 *
 * SPDX-License-Identifier: Apache-2.0 OR MIT
 */
#pragma once

// The C header's opaque type has the name of the class, which has another meaning here.
#define MaskedOcclusionCulling MOC_LinkedObject
#include "../include/MaskedOcclusionCullingAllocation.h"
#undef MaskedOcclusionCulling

// Until the end of the including file, MOC_Create stands for the prefixed name.
#include "../include/moc_names.h"

namespace moc_link
{

/** The library's object inside one from MaskedOcclusionCulling::Create; null for null. */
MOC_LinkedObject *ObjectOf(const MaskedOcclusionCulling *moc);

/** See MaskedOcclusionCullingAllocation.h. */
typedef MOC_DetailAllocation<MOC_DETAIL_EXCEPTIONS != 0> Allocation;

/** Whether the linked library has the version of the C header. */
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
