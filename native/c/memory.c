/* What compiled functions ask for: memory of arrays that they make for themselves, as counted
 * blocks, and other shapes of arrays.
 *
 * The names and the first five words of a block are those that Numba's code asks for.
 */
#include <stdint.h>
#include <stdlib.h>

#if defined(TOOTHSPACE_STATIC)
#define EXPORTED
#elif defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif

typedef struct {
    intptr_t references;
    void (*unused)(void);
    void *unused_too;
    void *data;
    size_t size;
} counted;

/* A block with its data at a multiple of an alignment; NULL where memory ends. */
void *NRT_MemInfo_alloc_aligned(size_t size, uint32_t alignment)
{
    counted *block = malloc(sizeof *block + size + alignment);
    if (!block)
        return NULL;
    uintptr_t data = (uintptr_t)(block + 1);
    block->references = 1;
    block->data = (void *)((data + alignment - 1) / alignment * alignment);
    block->size = size;
    return block;
}

void *NRT_MemInfo_alloc_safe_aligned(size_t size, uint32_t alignment)
{
    return NRT_MemInfo_alloc_aligned(size, alignment);
}

/* Called where the last reference is gone. */
void NRT_MemInfo_call_dtor(void *block) { free(block); }

/* Give back an array that an entry has returned. */
EXPORTED void toothspace_release(void *block)
{
    counted *given = block;
    if (given && --given->references == 0)
        free(given);
}

/* Strides of an array without gaps in another shape; 0 where the array has gaps. */
int32_t numba_attempt_nocopy_reshape(int64_t dimensions, const int64_t *shape,
                                     const int64_t *strides, int64_t new_dimensions,
                                     const int64_t *new_shape, int64_t *new_strides,
                                     int64_t item, int32_t columns_first)
{
    int64_t step = item;
    for (int64_t k = dimensions - 1; k >= 0; k--) {
        if (columns_first || (shape[k] > 1 && strides[k] != step))
            return 0;
        step *= shape[k];
    }
    step = item;
    for (int64_t k = new_dimensions - 1; k >= 0; k--) {
        new_strides[k] = step;
        step *= new_shape[k];
    }
    return 1;
}

/* Memory for a moment, as Numba asks for it. */
void *NRT_Allocate(size_t size) { return malloc(size); }
void NRT_Free(void *block) { free(block); }
