/* Memory with inaccessible pages before and after it, so that reading or writing a single byte outside crashes. */
#ifndef CAPI_TESTS_GUARDED_H
#define CAPI_TESTS_GUARDED_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include "small_windows.h"
#else
#include <sys/mman.h>
#include <unistd.h>
#endif

/* The page size. */
static inline size_t guarded_page(void)
{
#ifdef _WIN32
    SYSTEM_INFO info;
    GetSystemInfo(&info);
    return info.dwPageSize;
#else
    return (size_t)sysconf(_SC_PAGESIZE);
#endif
}

/* Whole pages, readable and writable; null if there are none. */
static inline unsigned char *guarded_map(size_t size)
{
#ifdef _WIN32
    return (unsigned char *)VirtualAlloc(NULL, size, MEM_RESERVE | MEM_COMMIT, PAGE_READWRITE);
#else
    void *pages = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return pages == MAP_FAILED ? NULL : (unsigned char *)pages;
#endif
}

/* From now on, reading or writing this page crashes. */
static inline void guarded_forbid(unsigned char *page, size_t size)
{
#ifdef _WIN32
    DWORD before;
    if (!VirtualProtect(page, size, PAGE_NOACCESS, &before))
        abort();
#else
    if (mprotect(page, size, PROT_NONE) != 0)
        abort();
#endif
}

static inline void guarded_unmap(unsigned char *pages, size_t size)
{
#ifdef _WIN32
    (void)size;
    if (!VirtualFree(pages, 0, MEM_RELEASE))
        abort();
#else
    if (munmap(pages, size) != 0)
        abort();
#endif
}

/* size bytes that end right before an inaccessible page, at a multiple of alignment if size is one. */
static inline void *guarded_alloc(size_t alignment, size_t size)
{
    const size_t page = guarded_page();
    const size_t middle = (size + page - 1) / page * page + page;
    unsigned char *base = guarded_map(middle + 2 * page);
    (void)alignment;
    if (base == NULL)
        return NULL;
    guarded_forbid(base + page + middle, page);
    guarded_forbid(base, page);
    /* The bytes before the block in its own pages are filled, and checked when it is released. */
    memset(base + page, 0xa5, middle - size);
    return base + page + middle - size;
}

/* Reports if a byte before the block has been written. */
static inline int guarded_intact(const void *block)
{
    const size_t page = guarded_page();
    const unsigned char *p = (const unsigned char *)block;
    const unsigned char *start = (const unsigned char *)((uintptr_t)p / page * page);
    const unsigned char *c;
    for (c = start; c < p; c++)
        if (*c != 0xa5)
            return 0;
    return 1;
}

/* Releases a block of `size` bytes. */
static inline void guarded_release(void *block, size_t size)
{
    const size_t page = guarded_page();
    const size_t middle = (size + page - 1) / page * page + page;
    unsigned char *base = (unsigned char *)block + size - middle - page;
    if (!guarded_intact(block)) {
        fprintf(stderr, "memory before a block was written\n");
        abort();
    }
    guarded_unmap(base, middle + 2 * page);
}

/* The pair of callbacks for an object; the sizes of live blocks are stored in a table. */
enum { GUARDED_BLOCKS = 64 };
static struct {
    void *block;
    size_t size;
} guarded_table[GUARDED_BLOCKS];

static inline void *guarded_callback_alloc(size_t alignment, size_t size)
{
    int i;
    for (i = 0; i < GUARDED_BLOCKS; i++) {
        if (guarded_table[i].block == NULL) {
            guarded_table[i].block = guarded_alloc(alignment, size);
            guarded_table[i].size = size;
            return guarded_table[i].block;
        }
    }
    return NULL;
}

static inline void guarded_callback_free(void *block)
{
    int i;
    for (i = 0; i < GUARDED_BLOCKS; i++) {
        if (guarded_table[i].block == block) {
            guarded_table[i].block = NULL;
            guarded_release(block, guarded_table[i].size);
            return;
        }
    }
    fprintf(stderr, "a block was freed that was not allocated\n");
    abort();
}

static inline int guarded_live_blocks(void)
{
    int i, n = 0;
    for (i = 0; i < GUARDED_BLOCKS; i++)
        n += guarded_table[i].block != NULL;
    return n;
}

#endif
