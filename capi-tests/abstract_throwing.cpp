// Allocation callbacks that throw, in a program whose class has virtual methods: Create and SetResolution rethrow,
// nothing leaks, and the object keeps its buffer.
#include "check.h"

#include <stddef.h>

#include <new>

#include "CullingThreadpool.h"
#include "MaskedOcclusionCulling.h"

namespace
{

typedef MaskedOcclusionCulling MOC;

int balance = 0;  // blocks not yet freed
int allowed = -1; // allocations left before one fails; negative: unlimited

void *Alloc(size_t alignment, size_t size)
{
    if (allowed == 0)
        throw std::bad_alloc();
    if (allowed > 0)
        --allowed;
    char *block = static_cast<char *>(malloc(size + alignment));
    char *aligned = block + alignment - reinterpret_cast<uintptr_t>(block) % alignment;
    reinterpret_cast<char **>(aligned)[-1] = block;
    ++balance;
    return aligned;
}

void Free(void *ptr)
{
    if (ptr != nullptr) {
        --balance;
        free(static_cast<char **>(ptr)[-1]);
    }
}

template <class Action> bool Throws(Action action)
{
    try {
        action();
    } catch (const std::bad_alloc &) {
        return true;
    }
    return false;
}

} // namespace

int main()
{
    MOC *moc = nullptr;
    int denied = 0;
    for (allowed = 0; Throws([&] { moc = MOC::Create(MOC::AVX2, Alloc, Free); }); allowed = ++denied) {
        CHECK(moc == nullptr);
        CHECK_EQ(balance, 0);
    }
    // The library's object and the one that wraps it.
    CHECK_EQ(denied, 2);
    CHECK(moc != nullptr);

    allowed = -1;
    moc->SetResolution(320, 200);
    const int before = balance;
    float quad[16];
    quad_at(quad, -1, -1, 1, 1, 10);
    moc->RenderTriangles(quad, QUAD, 2);
    allowed = 0;
    CHECK(Throws([&] { moc->SetResolution(640, 400); }));
    CHECK_EQ(balance, before);
    CHECK(moc->TestRect(-0.5f, -0.5f, 0.5f, 0.5f, 20) == MOC::OCCLUDED);
    {
        CullingThreadpool pool(1, 1, 1);
        pool.SetBuffer(moc);
        CHECK(Throws([&] { pool.SetResolution(640, 400); }));
        CHECK_EQ(balance, before);
    }
    allowed = -1;
    moc->SetResolution(640, 400);
    MOC::Destroy(moc);
    CHECK_EQ(balance, 0);
    return check_report("abstract_throwing");
}
