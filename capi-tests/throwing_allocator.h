// Shared by throwing_allocator.cpp and throwing_allocator_none.cpp.
#pragma once

#include "MaskedOcclusionCulling.h"

// Created in a unit without exceptions.
MaskedOcclusionCulling *CreateWithoutExceptions(MaskedOcclusionCulling::pfnAlignedAlloc alloc,
                                                MaskedOcclusionCulling::pfnAlignedFree release);
void SetResolutionWithoutExceptions(MaskedOcclusionCulling *moc, unsigned int width, unsigned int height);
