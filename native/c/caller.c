/* Calls functions of the compiled library from Python.
 *
 * An entry reads its arguments from one block of 64-bit words: a number is one word, an array
 * its size, address, shape and strides, a tuple the words of its members. This module checks
 * arguments against the types that the entry was compiled for and writes the block.
 * Stable interface of Python 3.11: one build serves all later versions.
 */
#define Py_LIMITED_API 0x030B0000
#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define MOST_WORDS 2048
#define MOST_ARRAYS 256
#define MOST_RESULTS 512 /* bytes */

typedef int32_t (*entry_function)(void *result, void **failure, const void *words);

typedef struct {
    int64_t words[MOST_WORDS];
    Py_buffer arrays[MOST_ARRAYS];
    int n_words, n_arrays;
} block;

/* Types are written as i8, f8, f4, b1, V232; f8[2C] for an array, with r behind it where it may be
 * read-only; (...) for a tuple; n for nothing. */

static int width_of(const char *type) { return atoi(type + 1); }

typedef struct {
    char kind, layout;
    int width, dimensions, readable;
} array_type;

/* Whether a type is that of an array; it is read, and the text moves behind it. */
static int is_array(const char **type, array_type *out)
{
    const char *p = *type;
    out->kind = *p++;
    out->width = 0;
    while (*p >= '0' && *p <= '9')
        out->width = 10 * out->width + (*p++ - '0');
    if (*p != '[')
        return 0;
    out->dimensions = p[1] - '0';
    out->layout = p[2];
    out->readable = p[4] == 'r';
    *type = p + 4 + out->readable;
    return 1;
}

/* Whether the items of a buffer are those of a type; of a structure (V) its size tells. */
static int same_items(const Py_buffer *view, const array_type *type)
{
    const char *format = view->format ? view->format : "B";
    const char *known = type->kind == 'f'   ? "df"
                        : type->kind == 'b' ? "?"
                        : type->kind == 'u' ? "ILQN"
                                            : "ilqn";
    if (view->itemsize != type->width)
        return 0;
    if (type->kind == 'V')
        return *format == 'T';
    if (*format == '@' || *format == '=')
        format++;
    return format[0] && !format[1] && strchr(known, format[0]);
}

static int put_array(block *b, PyObject *value, const array_type *type)
{
    int dimensions = type->dimensions;
    int flags = PyBUF_FORMAT | PyBUF_STRIDES | (type->readable ? 0 : PyBUF_WRITABLE);
    if (b->n_arrays == MOST_ARRAYS || b->n_words + 2 + 2 * dimensions > MOST_WORDS)
        return 0;
    Py_buffer *view = &b->arrays[b->n_arrays];
    if (PyObject_GetBuffer(value, view, flags) < 0) {
        PyErr_Clear();
        return 0;
    }
    b->n_arrays++;
    if (view->ndim != dimensions || !same_items(view, type))
        return 0;
    if (type->layout != 'A' && !PyBuffer_IsContiguous(view, type->layout))
        return 0;
    int64_t size = 1, step = view->itemsize;
    int64_t *words = b->words + b->n_words, *strides = words + 2 + dimensions;
    for (int k = 0; k < dimensions; k++) {
        words[2 + k] = view->shape[k];
        strides[k] = view->strides[k];
        size *= view->shape[k];
    }
    /* strides of an array without items, or of an axis of one item, may be anything */
    for (int k = 0; type->layout != 'A' && k < dimensions; k++) {
        int axis = type->layout == 'C' ? dimensions - 1 - k : k;
        strides[axis] = step;
        step *= view->shape[axis];
    }
    words[0] = size;
    words[1] = (int64_t)(intptr_t)view->buf;
    b->n_words += 2 + 2 * dimensions;
    return 1;
}

static int put_number(block *b, PyObject *value, const char **type)
{
    char kind = **type;
    *type += 2;
    if (b->n_words == MOST_WORDS)
        return 0;
    int64_t *word = &b->words[b->n_words++];
    if (kind == 'f') {
        double number = PyFloat_AsDouble(value);
        memcpy(word, &number, sizeof number);
    } else if (kind == 'b') {
        *word = PyObject_IsTrue(value);
    } else {
        PyObject *index = PyNumber_Index(value);
        *word = index ? PyLong_AsLongLong(index) : -1;
        Py_XDECREF(index);
    }
    if (PyErr_Occurred()) {
        PyErr_Clear();
        return 0;
    }
    return 1;
}

static int put(block *b, PyObject *value, const char **type);

/* Members of a tuple; the type stands behind its opening bracket. */
static int put_members(block *b, PyObject *value, const char **type)
{
    if (!PyTuple_Check(value))
        return 0;
    Py_ssize_t count = PyTuple_Size(value);
    for (Py_ssize_t k = 0; k < count; k++) {
        if (**type == ')' || !put(b, PyTuple_GetItem(value, k), type))
            return 0;
        if (**type == ',')
            ++*type;
    }
    if (**type != ')')
        return 0;
    ++*type;
    return 1;
}

static int put(block *b, PyObject *value, const char **type)
{
    if (**type == '(') {
        ++*type;
        return put_members(b, value, type);
    }
    array_type array;
    return is_array(type, &array) ? put_array(b, value, &array) : put_number(b, value, type);
}

/* Read what an entry has left, in the layout of a C structure. */

static const char *aligned(const char *place, const char *start, int width)
{
    Py_ssize_t beyond = (place - start) % width;
    return beyond ? place + width - beyond : place;
}

static PyObject *taken(const char **type, const char **place, const char *start)
{
    const char *p = *type;
    if (*p == 'n') {
        *type = p + 1;
        Py_RETURN_NONE;
    }
    if (*p == '(') {
        PyObject *members = PyList_New(0);
        *type = p + 1;
        while (members && **type != ')') {
            PyObject *member = taken(type, place, start);
            if (!member || PyList_Append(members, member) < 0)
                Py_CLEAR(members);
            Py_XDECREF(member);
            if (**type == ',')
                ++*type;
        }
        ++*type;
        PyObject *tuple = members ? PyList_AsTuple(members) : NULL;
        Py_XDECREF(members);
        return tuple;
    }
    int width = width_of(p);
    const char *here = aligned(*place, start, width);
    *place = here + width;
    *type = p + 2;
    if (*p == 'b')
        return PyBool_FromLong(*here & 1);
    if (*p == 'i') {
        int64_t number;
        memcpy(&number, here, sizeof number);
        return PyLong_FromLongLong(number);
    }
    if (width == 4) {
        float number;
        memcpy(&number, here, sizeof number);
        return PyFloat_FromDouble(number);
    }
    double number;
    memcpy(&number, here, sizeof number);
    return PyFloat_FromDouble(number);
}

static PyObject *call(PyObject *self, PyObject *args)
{
    unsigned long long address;
    const char *types, *results;
    PyObject *values;
    (void)self;
    if (!PyArg_ParseTuple(args, "KyyO!", &address, &types, &results, &PyTuple_Type, &values))
        return NULL;
    block given, *b = &given;
    b->n_words = b->n_arrays = 0;
    int64_t result[MOST_RESULTS / 8] = {0};
    int32_t code = 0;
    const char *type = types + 1;
    int fits = put_members(b, values, &type);
    if (fits) {
        void *failure = NULL;
        entry_function function = (entry_function)(uintptr_t)address;
        PyThreadState *state = PyEval_SaveThread();
        code = function(result, &failure, b->words);
        PyEval_RestoreThread(state);
    }
    for (int k = 0; k < b->n_arrays; k++)
        PyBuffer_Release(&b->arrays[k]);
    if (!fits)
        Py_RETURN_NOTIMPLEMENTED;
    if (code > 0) {
        PyErr_SetString(PyExc_ArithmeticError, "compiled code met a number that it cannot use");
        return NULL;
    }
    const char *place = (const char *)result;
    return taken(&results, &place, place);
}

static PyMethodDef methods[] = {
    {"call", call, METH_VARARGS,
     "call(address, types, results, arguments): NotImplemented where types differ"},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT, "caller", "Calls functions of the compiled library.", -1, methods,
    NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_caller(void) { return PyModule_Create(&definition); }
