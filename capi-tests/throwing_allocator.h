// What throwing_allocator.cpp and throwing_allocator_none.cpp share.
#pragma once

#include "MaskedOcclusionCulling.h"

// Made in a unit without exceptions.
MaskedOcclusionCulling *CreateWithoutExceptions(MaskedOcclusionCulling::pfnAlignedAlloc alloc,
                                                MaskedOcclusionCulling::pfnAlignedFree release);
void SetResolutionWithoutExceptions(MaskedOcclusionCulling *moc, unsigned int width, unsigned int height);
