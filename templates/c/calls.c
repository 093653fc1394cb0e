/* Calls that need nothing of Python: arrays of one native type with at most one axis before their
   components, and plain floats. For all others None is returned, and the Python function prepares
   them. A call of one row takes 1 µs so, and 10 µs through the checks in Python. */

/* An argument of `width` components; of width 0, a number for each row, also on an axis of its own. */
static int rows_of(PyObject *given, const int type, const npy_intp width, Rows *found)
{
    PyArrayObject *array = (PyArrayObject *)given;
    if (!width && type == NPY_DOUBLE && PyFloat_Check(given)) {
        *found = (Rows) { NULL, 0, 0, sizeof(double), PyFloat_AS_DOUBLE(given) };
        found->data = (char *)&found->number;
        return 1;
    }
    if (!PyArray_CheckExact(given) || PyArray_TYPE(array) != type || !PyArray_ISBEHAVED_RO(array)) {
        return 0;
    }
    const int axes = PyArray_NDIM(array), inner = width || axes == 2, leading = axes - inner;
    if (leading < 0 || leading > 1 || (inner && PyArray_DIM(array, leading) != (width ? width : 1))) {
        return 0;
    }
    const npy_intp size = PyArray_ITEMSIZE(array);
    found->data = PyArray_BYTES(array);
    found->rows = leading ? PyArray_DIM(array, 0) : 0;
    found->step = leading ? PyArray_STRIDE(array, 0) : 0;
    found->stride = inner ? PyArray_STRIDE(array, leading) : size;
    return !(leading && found->rows == 0) && !(found->step % size) && !(found->stride % size);
}

/* The same of an array to be filled, which must have the result's shape and regular entries. */
static int rows_of_out(
    PyObject *given, const int type, const int axes, const npy_intp *shape, const int leading,
    Rows *found)
{
    PyArrayObject *array = (PyArrayObject *)given;
    if (!PyArray_CheckExact(given) || PyArray_TYPE(array) != type || !PyArray_ISBEHAVED(array)
        || PyArray_NDIM(array) != axes || !PyArray_CompareLists(PyArray_DIMS(array), shape, axes)) {
        return 0;
    }
    const npy_intp size = PyArray_ITEMSIZE(array);
    found->data = PyArray_BYTES(array);
    found->rows = leading ? shape[0] : 0;
    found->step = leading ? PyArray_STRIDE(array, 0) : 0;
    found->stride = axes > leading ? PyArray_STRIDE(array, axes - 1) : size;
    for (int k = leading + 1; k < axes; k++) {
        if (PyArray_STRIDE(array, k - 1) != shape[k] * PyArray_STRIDE(array, k)) {
            return 0;
        }
    }
    return !(found->step % size) && !(found->stride % size);
}

/* Whether memory from the first to the last byte of one is also that of the other. */
static int may_overlap(const Rows *one, const npy_intp width, const Rows *other, const npy_intp many)
{
    const Rows *both[2] = { one, other };
    const npy_intp widths[2] = { width, many };
    char *low[2], *high[2];
    for (int k = 0; k < 2; k++) {
        const npy_intp steps[2] = {
            (both[k]->rows > 0 ? both[k]->rows - 1 : 0) * both[k]->step,
            (widths[k] - 1) * both[k]->stride,
        };
        low[k] = high[k] = both[k]->data;
        for (int i = 0; i < 2; i++) {
            *(steps[i] < 0 ? &low[k] : &high[k]) += steps[i];
        }
        high[k] += sizeof(double);
    }
    return low[0] < high[1] && low[1] < high[0];
}

/* The memory of a large result, kept for the next of its size when nobody refers to it any more:
   fresh pages cost as much time as filling them. Blocks of up to 32 MB malloc keeps itself; what is
   kept here, the system may take back. */
#if defined(__linux__) && defined(MADV_FREE)
enum { LEAST_KEPT = 1 << 25, MOST_KEPT = 1 << 30, PAGE = 1 << 21 }; /* bytes */

static struct {
    void *data;
    size_t bytes;
} kept;

static void keep(PyObject *owner)
{
    free(kept.data);
    kept.data = PyCapsule_GetPointer(owner, NULL);
    kept.bytes = (size_t)(uintptr_t)PyCapsule_GetContext(owner);
    madvise(kept.data, kept.bytes, MADV_FREE);
}

static PyObject *new_large(const int axes, const npy_intp *shape, const int type, const size_t bytes)
{
    void *data = NULL;
    if (kept.bytes == bytes) {
        data = kept.data;
        kept.data = NULL;
        kept.bytes = 0;
    } else if (posix_memalign(&data, PAGE, bytes)) {
        return PyErr_NoMemory();
    } else {
        madvise(data, bytes, MADV_HUGEPAGE);
    }
    PyObject *owner = PyCapsule_New(data, NULL, keep);
    if (owner == NULL) {
        free(data);
        return NULL;
    }
    PyCapsule_SetContext(owner, (void *)(uintptr_t)bytes);
    PyObject *result = PyArray_SimpleNewFromData(axes, shape, type, data);
    if (result == NULL || PyArray_SetBaseObject((PyArrayObject *)result, owner) < 0) {
        Py_XDECREF(result);
        Py_XDECREF(result == NULL ? owner : NULL);
        return NULL;
    }
    return result;
}
#else
enum { LEAST_KEPT = 1, MOST_KEPT = 0 };
#define new_large(axes, shape, type, bytes) NULL
#endif

static PyObject *new_result(const int axes, const npy_intp *shape, const int type)
{
    const npy_intp each = type == NPY_FLOAT ? sizeof(float) : sizeof(double);
    const npy_intp bytes = each * PyArray_MultiplyList(shape, axes);
    if (bytes > LEAST_KEPT && bytes <= MOST_KEPT) {
        return new_large(axes, shape, type, (size_t)bytes);
    }
    return PyArray_SimpleNew(axes, shape, type);
}

/* empty(shape, type): the same for threads, which share the work in Python. */
static PyObject *empty(PyObject *self, PyObject *given)
{
    PyArray_Dims shape = { NULL, 0 };
    int type;
    (void)self;
    if (!PyArg_ParseTuple(given, "O&i", PyArray_IntpConverter, &shape, &type)) {
        return NULL;
    }
    PyObject *result = new_result(shape.len, shape.ptr, type);
    PyDimMem_FREE(shape.ptr);
    return result;
}

/* function(*arguments, out): the result, or None. */
static PyObject *call(PyObject *self, PyObject *const *given, const Py_ssize_t many)
{
    const struct kernel *kernel = &table[PyLong_AsLong(self)];
    const int count = kernel->arguments;
    Rows rows[MOST + 1];
    npy_intp shape[4], leading = 0;
    int axes = 0;
    const int first = PyFloat_Check(given[0]) && count > 1; /* the argument that tells the type */
    if (many != count + 1 || !PyArray_CheckExact(given[first])) {
        Py_RETURN_NONE;
    }
    const int type = PyArray_TYPE((PyArrayObject *)given[first]);
    if (type != NPY_DOUBLE && type != NPY_FLOAT) {
        Py_RETURN_NONE;
    }
    for (int k = 0; k < count; k++) {
        if (!rows_of(given[k], type, kernel->widths[k], &rows[k])) {
            Py_RETURN_NONE;
        }
        if (rows[k].rows > leading) {
            leading = rows[k].rows;
        }
    }
    for (int k = 0; k < count; k++) { /* one row serves all */
        if (rows[k].rows == 1 && leading > 1) {
            rows[k].step = 0;
        } else if (rows[k].rows && rows[k].rows != leading) {
            Py_RETURN_NONE;
        }
    }
    if (leading) {
        shape[axes++] = leading;
    }
    for (int k = 0; k < kernel->axes; k++) {
        shape[axes++] = kernel->shape[k];
    }
    PyObject *result = given[count];
    if (result == Py_None) {
        result = new_result(axes, shape, type);
        if (result == NULL) {
            return NULL;
        }
    } else {
        Py_INCREF(result);
    }
    Rows *out = &rows[count];
    if (!rows_of_out(result, type, axes, shape, leading > 0, out)) {
        Py_DECREF(result);
        Py_RETURN_NONE;
    }
    for (int k = 0; k < count && given[count] != Py_None; k++) {
        const npy_intp width = kernel->widths[k] ? kernel->widths[k] : 1;
        if (may_overlap(&rows[k], width, out, kernel->entries)) {
            Py_DECREF(result);
            Py_RETURN_NONE;
        }
    }
    PyThreadState *state = leading < FREE ? NULL : PyEval_SaveThread();
    kernel->loops[type == NPY_FLOAT](leading ? (size_t)leading : 1, rows);
    VECTORS_DONE();
    if (state != NULL) {
        PyEval_RestoreThread(state);
    }
    return result;
}

static PyMethodDef methods[] = {
    { "empty", empty, METH_VARARGS, NULL },
    { NULL, NULL, 0, NULL },
};

static PyMethodDef called = { "call", (PyCFunction)(void (*)(void))call, METH_FASTCALL, NULL };
