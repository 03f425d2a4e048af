// A unit compiled as if with -fno-exceptions, in a program that uses exceptions elsewhere.
#define MOC_DETAIL_EXCEPTIONS 0
#include "throwing_allocator.h"

MaskedOcclusionCulling *CreateWithoutExceptions(MaskedOcclusionCulling::pfnAlignedAlloc alloc,
                                                MaskedOcclusionCulling::pfnAlignedFree release)
{
    return MaskedOcclusionCulling::Create(MaskedOcclusionCulling::AVX512, alloc, release);
}

void SetResolutionWithoutExceptions(MaskedOcclusionCulling *moc, unsigned int width, unsigned int height)
{
    moc->SetResolution(width, height);
}
