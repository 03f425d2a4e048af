/* Memory with forbidden pages before and after it, so that one byte read or written outside is a crash. */
#ifndef CAPI_TESTS_GUARDED_H
#define CAPI_TESTS_GUARDED_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* size bytes that end right before a forbidden page, at a multiple of alignment when size is one. */
static inline void *guarded_alloc(size_t alignment, size_t size)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    const size_t middle = (size + page - 1) / page * page + page;
    unsigned char *base = (unsigned char *)mmap(NULL, middle + 2 * page, PROT_READ | PROT_WRITE,
                                                MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    (void)alignment;
    if (base == (unsigned char *)MAP_FAILED)
        return NULL;
    if (mprotect(base + page + middle, page, PROT_NONE) != 0 || mprotect(base, page, PROT_NONE) != 0)
        abort();
    /* What lies before the block in its own pages is filled, and checked when it is released. */
    memset(base + page, 0xa5, middle - size);
    return base + page + middle - size;
}

/* Says when a byte before the block was written. */
static inline int guarded_intact(const void *block)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    const unsigned char *p = (const unsigned char *)block;
    const unsigned char *start = (const unsigned char *)((uintptr_t)p / page * page);
    const unsigned char *c;
    for (c = start; c < p; c++)
        if (*c != 0xa5)
            return 0;
    return 1;
}

/* Takes back a block of `size` bytes. */
static inline void guarded_release(void *block, size_t size)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    const size_t middle = (size + page - 1) / page * page + page;
    unsigned char *base = (unsigned char *)block + size - middle - page;
    if (!guarded_intact(block)) {
        fprintf(stderr, "memory before a block was written\n");
        abort();
    }
    if (munmap(base, middle + 2 * page) != 0)
        abort();
}

/* The pair of callbacks for an object: the sizes of live blocks are kept in a table. */
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
