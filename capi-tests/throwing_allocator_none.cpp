// A unit as it is without exceptions (-fno-exceptions), in a program that has them elsewhere.
#undef __cpp_exceptions
#undef __EXCEPTIONS
#undef _CPPUNWIND
#include "throwing_allocator.h"

static_assert(MOC_DETAIL_EXCEPTIONS == 0, "the header takes this for a unit without exceptions");

MaskedOcclusionCulling *CreateWithoutExceptions(MaskedOcclusionCulling::pfnAlignedAlloc alloc,
                                                MaskedOcclusionCulling::pfnAlignedFree release)
{
    return MaskedOcclusionCulling::Create(MaskedOcclusionCulling::AVX512, alloc, release);
}

void SetResolutionWithoutExceptions(MaskedOcclusionCulling *moc, unsigned int width, unsigned int height)
{
    moc->SetResolution(width, height);
}
