/* What compiled functions ask for: other shapes of arrays, under the name that Numba gives it. */
#include <stdint.h>

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
