/*
 * A plugin for the engine in facade.c, in C: it has its own facade, uses the library with the prefix, and loads a copy
 * without one.
 */
#define _GNU_SOURCE
#include <dlfcn.h>

#include "masked_occlusion_culling.h"

int MOC_Destroy(void);
int plugin_with(const char *path);

int MOC_Destroy(void)
{
    return 2000;
}

#define EXPECT(condition)    \
    do                       \
    {                        \
        if (!(condition))    \
            return __LINE__; \
    } while (0)

/* Returns 0, or the line of the failed check. */
int plugin_with(const char *path)
{
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    MOC_Status (*create)(const MOC_Settings *, MaskedOcclusionCulling **);
    MOC_Status (*set_resolution)(MaskedOcclusionCulling *, uint32_t, uint32_t);
    MOC_Status (*clear)(MaskedOcclusionCulling *);
    MOC_Status (*destroy)(MaskedOcclusionCulling *);
    MaskedOcclusionCulling *theirs = NULL, *ours = NULL;

    EXPECT(library != NULL);
    *(void **)&create = dlsym(library, "MOC_Create");
    *(void **)&set_resolution = dlsym(library, "MOC_SetResolution");
    *(void **)&clear = dlsym(library, "MOC_ClearBuffer");
    *(void **)&destroy = dlsym(library, "MOC_Destroy");
    EXPECT(create != NULL && set_resolution != NULL && clear != NULL && destroy != NULL);
    EXPECT(dlsym(library, "acme_MOC_Create") == NULL);

    EXPECT(create(NULL, &theirs) == MOC_STATUS_OK && acme_MOC_Create(NULL, &ours) == MOC_STATUS_OK);
    EXPECT(set_resolution(theirs, 64, 64) == MOC_STATUS_OK && acme_MOC_SetResolution(ours, 64, 64) == MOC_STATUS_OK);
    EXPECT(clear(theirs) == MOC_STATUS_OK && acme_MOC_ClearBuffer(ours) == MOC_STATUS_OK);
    EXPECT(destroy(theirs) == MOC_STATUS_OK && acme_MOC_Destroy(ours) == MOC_STATUS_OK);
    return 0;
}
