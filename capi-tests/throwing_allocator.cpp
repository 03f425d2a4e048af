// Allocation callbacks that throw: Create and SetResolution rethrow, nothing leaks, and the object keeps its buffer.
#include "check.h"
#include "throwing_allocator.h"

#include "CullingThreadpool.h"

#include <new>
#include <string>

namespace
{

typedef MaskedOcclusionCulling MOC;

// The program's own exception type, with a member that must be freed.
struct Denied
{
    std::string why;
};

int balance = 0;   // blocks not yet freed
int allowed = -1;  // allocations left before one fails; negative: unlimited
bool own = false;  // throw Denied instead of std::bad_alloc
bool quiet = false; // return null instead of throwing

void *Alloc(size_t alignment, size_t size)
{
    if (allowed == 0) {
        if (quiet)
            return nullptr;
        if (own)
            throw Denied{"by an allocator that is not the system's, and with a text of its own"};
        throw std::bad_alloc();
    }
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

// The type of exception that an action throws: 0 none, 1 std::bad_alloc, 2 Denied.
template <class Action> int Thrown(Action action)
{
    try {
        action();
    } catch (const std::bad_alloc &) {
        return 1;
    } catch (const Denied &denied) {
        CHECK(denied.why.size() > 20);
        return 2;
    }
    return 0;
}

void WallAt(MOC *moc, float w)
{
    float quad[16];
    quad_at(quad, -1, -1, 1, 1, w);
    moc->RenderTriangles(quad, QUAD, 2);
}

bool Hidden(const MOC *moc) { return moc->TestRect(-0.5f, -0.5f, 0.5f, 0.5f, 20) == MOC::OCCLUDED; }

void CreateThrows()
{
    for (int kind = 0; kind < 2; ++kind) {
        own = kind != 0;
        MOC *moc = nullptr;
        allowed = 0;
        CHECK_EQ(Thrown([&] { moc = MOC::Create(MOC::AVX512, Alloc, Free); }), 1 + kind);
        CHECK(moc == nullptr);
        CHECK_EQ(balance, 0);
        CHECK_EQ(MOC::GetLastStatus(), MOC_STATUS_OUT_OF_MEMORY);
    }
    quiet = true;
    CHECK_EQ(Thrown([] { CHECK(MOC::Create(MOC::AVX512, Alloc, Free) == nullptr); }), 0);
    quiet = false;
    allowed = -1;
}

void SetResolutionThrows()
{
    MOC *moc = MOC::Create(MOC::AVX512, Alloc, Free);
    CHECK(moc != nullptr);
    // The user's own pair, not the wrappers around it.
    MOC::pfnAlignedAlloc alloc = nullptr;
    MOC::pfnAlignedFree release = nullptr;
    moc->GetAllocFreeCallback(alloc, release);
    CHECK(alloc == Alloc && release == Free);

    const int empty = balance;
    own = true;
    for (int some = 0; some < 4; ++some) {
        allowed = some;
        const int thrown = Thrown([&] { moc->SetResolution(320, 200); });
        if (thrown == 0)
            break; // this many allocations suffice
        CHECK_EQ(thrown, 2);
        CHECK_EQ(balance, empty);
        unsigned int w = 1, h = 1;
        moc->GetResolution(w, h);
        CHECK(w == 0 && h == 0);
        CHECK(some < 3);
    }
    allowed = -1;
    moc->SetResolution(320, 200);
    WallAt(moc, 10);
    const int with_buffer = balance;
    CHECK(with_buffer > empty);

    // A larger size fails at each of its allocations in turn: the wall is still there.
    for (int some = 0; some < with_buffer - empty; ++some) {
        allowed = some;
        CHECK_EQ(Thrown([&] { moc->SetResolution(640, 400); }), 2);
        unsigned int w = 0, h = 0;
        moc->GetResolution(w, h);
        CHECK(w == 320 && h == 200);
        CHECK(Hidden(moc));
        CHECK_EQ(balance, with_buffer);
    }

    // A C function cannot throw, and an exception swallowed there is not rethrown later.
    allowed = 0;
    CHECK_EQ(MOC_SetResolution(moc, 640, 400), MOC_STATUS_OUT_OF_MEMORY);
    allowed = -1;
    CHECK_EQ(Thrown([&] { moc->SetResolution(64, 64); }), 0);
    MOC::Destroy(moc);
    CHECK_EQ(balance, 0);
}

void PoolThrows()
{
    MOC *moc = MOC::Create(MOC::AVX512, Alloc, Free);
    moc->SetResolution(320, 200);
    {
        CullingThreadpool pool(2, 2, 2);
        pool.SetBuffer(moc);
        pool.WakeThreads();
        own = true;
        allowed = 0;
        CHECK_EQ(Thrown([&] { pool.SetResolution(640, 400); }), 2);
        allowed = -1;
        // It still works.
        float quad[16];
        quad_at(quad, -1, -1, 1, 1, 10);
        pool.ClearBuffer();
        pool.RenderTriangles(quad, QUAD, 2);
        pool.Flush();
        CHECK(Hidden(moc));
        pool.SetResolution(640, 400);
    }
    unsigned int w = 0, h = 0;
    moc->GetResolution(w, h);
    CHECK(w == 640 && h == 400);
    MOC::Destroy(moc);
    CHECK_EQ(balance, 0);
}

// A callback that uses the library itself, on its own object whose allocator throws.
void *Nested(size_t alignment, size_t size)
{
    const int before = allowed;
    allowed = 0;
    CHECK_EQ(Thrown([] { MOC::Create(MOC::AVX512, Alloc, Free); }), 2);
    allowed = before;
    return Alloc(alignment, size);
}

void NestedCallsKeepTheirsApart()
{
    own = true;
    allowed = -1;
    MOC *moc = nullptr;
    CHECK_EQ(Thrown([&] { moc = MOC::Create(MOC::AVX512, Nested, Free); }), 0);
    CHECK(moc != nullptr);
    CHECK_EQ(Thrown([&] { moc->SetResolution(64, 64); }), 0);
    MOC::Destroy(moc);
    CHECK_EQ(balance, 0);
}

void WithoutExceptionsItIsNull()
{
    allowed = 0;
    quiet = true;
    CHECK(CreateWithoutExceptions(Alloc, Free) == nullptr);
    allowed = -1;
    MOC *moc = CreateWithoutExceptions(Alloc, Free);
    CHECK(moc != nullptr);
    allowed = 0;
    SetResolutionWithoutExceptions(moc, 64, 64);
    CHECK_EQ(MOC::GetLastStatus(), MOC_STATUS_OUT_OF_MEMORY);
    allowed = -1;
    quiet = false;
    MOC::Destroy(moc);

    // An object created in a unit with exceptions and resized in one without: caught, and not rethrown.
    moc = MOC::Create(MOC::AVX512, Alloc, Free);
    allowed = 0;
    CHECK_EQ(Thrown([&] { SetResolutionWithoutExceptions(moc, 64, 64); }), 0);
    CHECK_EQ(MOC::GetLastStatus(), MOC_STATUS_OUT_OF_MEMORY);
    allowed = -1;
    MOC::Destroy(moc);
    CHECK_EQ(balance, 0);
}

} // namespace

int main()
{
    CreateThrows();
    SetResolutionThrows();
    PoolThrows();
    NestedCallsKeepTheirsApart();
    WithoutExceptionsItIsNull();
    return check_report("throwing_allocator");
}
