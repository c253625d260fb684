# cython: language_level=3, embedsignature=False
"""Loads the shared libraries of kernels and calls their functions.

A call with arrays that the C function can take as they are goes straight to it; any other call goes
to a Python function that checks, converts and broadcasts (``moro_codegen.calls``), which reaches
the library's batch function through a NumPy generalized universal function. Compiled once, with the
package; nothing here knows of a particular kernel.
"""

cimport numpy as np
from cpython.object cimport PyObject
from cpython.ref cimport Py_INCREF

import os

import numpy

np.import_array()
np.import_ufunc()

cdef extern from "dlfcn.h" nogil:
    void *dlopen(const char *path, int flags)
    void *dlsym(void *library, const char *symbol)
    int dlclose(void *library)
    char *dlerror()
    int RTLD_NOW, RTLD_LOCAL

cdef extern from "fenv.h" nogil:
    ctypedef struct fenv_t:
        pass
    int fegetenv(fenv_t *environment)
    int fesetenv(const fenv_t *environment)
    int feclearexcept(int exceptions)
    int FE_ALL_EXCEPT

cdef extern from "Python.h":
    ctypedef void *PyCFunction
    ctypedef struct PyMethodDef:
        const char *ml_name
        PyCFunction ml_meth
        int ml_flags
        const char *ml_doc
    int METH_FASTCALL, METH_KEYWORDS
    object PyCFunction_New(PyMethodDef *, object)
    object PyObject_Vectorcall(object, PyObject **, size_t, PyObject *)
    Py_ssize_t PyTuple_GET_SIZE(PyObject *)
    PyObject *PyTuple_GET_ITEM(PyObject *, Py_ssize_t)
    int PyTuple_CheckExact(PyObject *)
    int PyUnicode_CompareWithASCIIString(PyObject *, const char *)
    PyObject *Py_None

cdef extern from "numpy/arrayobject.h":
    ctypedef struct PyArrayObject
    int PyArray_CheckExact(PyObject *)
    int PyArray_TYPE(PyArrayObject *)
    int PyArray_NDIM(PyArrayObject *)
    int PyArray_ITEMSIZE(PyArrayObject *)
    int PyArray_ISBEHAVED(PyArrayObject *)
    int PyArray_ISCARRAY(PyArrayObject *)
    int PyArray_ISCARRAY_RO(PyArrayObject *)
    np.npy_intp *PyArray_DIMS(PyArrayObject *)
    np.npy_intp *PyArray_STRIDES(PyArrayObject *)
    void *PyArray_DATA(PyArrayObject *)
    object PyArray_EMPTY(int, np.npy_intp *, int, int)

cdef extern from "numpy/ufuncobject.h":
    ctypedef struct PyUFuncObject:
        PyObject *obj

cdef extern from *:
    """
    typedef void (*moro_single)(void);
    typedef const char *(*moro_said)(void);
    typedef void (*moro_loop)(char **, const npy_intp *, const npy_intp *, void *);

    /* Calls a C function whose n arguments are pointers, to double or to float. */
    static void moro_apply(moro_single function, int n, void **p)
    {
    #define T2 void *, void *
    #define T4 T2, T2
    #define T8 T4, T4
    #define A2(i) p[i], p[i + 1]
    #define A4(i) A2(i), A2(i + 2)
    #define A8(i) A4(i), A4(i + 4)
    #define CALL(types, arguments) ((void (*)(types))function)(arguments); break
        switch (n) {
    #define LIST(...) __VA_ARGS__
        case 1: CALL(void *, p[0]);
        case 2: CALL(LIST(T2), LIST(A2(0)));
        case 3: CALL(LIST(T2, void *), LIST(A2(0), p[2]));
        case 4: CALL(LIST(T4), LIST(A4(0)));
        case 5: CALL(LIST(T4, void *), LIST(A4(0), p[4]));
        case 6: CALL(LIST(T4, T2), LIST(A4(0), A2(4)));
        case 7: CALL(LIST(T4, T2, void *), LIST(A4(0), A2(4), p[6]));
        case 8: CALL(LIST(T8), LIST(A8(0)));
        case 9: CALL(LIST(T8, void *), LIST(A8(0), p[8]));
        case 10: CALL(LIST(T8, T2), LIST(A8(0), A2(8)));
        }
    }
    """
    ctypedef void (*Single "moro_single")() noexcept nogil
    ctypedef const char *(*Said "moro_said")() noexcept
    ctypedef void (*Loop "moro_loop")(
        char **, const np.npy_intp *, const np.npy_intp *, void *) noexcept nogil
    void moro_apply(Single, int, void **) noexcept nogil

cdef enum:
    STRAIGHT = 10  # pointers that moro_apply can pass
    OPERANDS = 32  # arguments of a gufunc
    DIMENSIONS = 4


cdef class Library:
    """A shared library, open for as long as this object lives."""

    cdef void *handle
    cdef readonly str path

    def __cinit__(self, path):
        cdef fenv_t environment
        self.path = os.fspath(path)
        spelled = None
        while spelled != _spelled_by_inode(self.path):  # else the file was replaced meanwhile
            if self.handle is not NULL:
                dlclose(self.handle)
            spelled = _spelled_by_inode(self.path)
            # what -ffast-math links into a library turns small numbers to zero from here on
            fegetenv(&environment)
            self.handle = dlopen(os.fsencode(spelled), RTLD_NOW | RTLD_LOCAL)
            fesetenv(&environment)
            if self.handle is NULL:
                raise OSError(f"cannot load {self.path}: {dlerror().decode(errors='replace')}")

    def __dealloc__(self):
        if self.handle is not NULL:
            dlclose(self.handle)

    def __repr__(self):
        return f"Library({self.path!r})"

    cdef void *symbol(self, str name) except NULL:
        cdef void *address = dlsym(self.handle, name.encode())
        if address is NULL:
            raise OSError(f"{self.path} does not export {name}")
        return address

    def text(self, str name):
        """Return the text that a symbol of the library is."""
        return (<const char *>self.symbol(name)).decode(errors="replace")

    def said(self, str name):
        """Return the text that a function of the library gives, or None."""
        cdef const char *text = (<Said>self.symbol(name))()
        return None if text is NULL else text.decode(errors="replace")


def _spelled_by_inode(path):
    """Return the path, spelled differently for every file that was ever there.

    dlopen knows a library by the spelling of its path, and would return the one it loaded before
    the file was replaced. The inode's digits, as "./" or "/", make the spelling the file's own.
    """
    folder, name = os.path.split(os.path.abspath(path))
    digits = bin(os.stat(path).st_ino)[2:]
    return folder + "/" + "".join("./" if digit == "1" else "/" for digit in digits) + name


cdef class _Batch:
    """What a gufunc points to; it keeps addresses only, and this object."""

    cdef Library library
    cdef bytes name
    cdef np.PyUFuncGenericFunction function
    cdef void *loop
    cdef char types[OPERANDS]


cdef void _run(
    char **args, const np.npy_intp *sizes, const np.npy_intp *strides, void *loop
) noexcept nogil:
    """Run a library's loop. Like a single call, it raises no floating-point warning."""
    (<Loop>loop)(args, sizes, strides, NULL)
    feclearexcept(FE_ALL_EXCEPT)


cdef int _type_of(dtype) except -1:
    """Return NumPy's number of float64 or float32."""
    cdef int number = numpy.dtype(dtype).num
    if number not in (np.NPY_DOUBLE, np.NPY_FLOAT):
        raise TypeError(f"kernels compute with float64 or float32, not {dtype}")
    return number


def gufunc(
    Library library not None, str symbol, str name, str signature, int nin, int nout, dtype
):
    """Return a NumPy generalized universal function whose loop is a symbol of the library."""
    if nin + nout > OPERANDS:
        raise ValueError(f"{name} has {nin + nout} arguments, at most {OPERANDS} are possible")
    cdef _Batch batch = _Batch.__new__(_Batch)
    batch.library = library
    batch.name = name.encode()
    batch.function = <np.PyUFuncGenericFunction>_run
    batch.loop = library.symbol(symbol)
    for i in range(nin + nout):
        batch.types[i] = <char>_type_of(dtype)
    ufunc = np.PyUFunc_FromFuncAndDataAndSignature(
        &batch.function, &batch.loop, batch.types, 1, nin, nout, np.PyUFunc_None, batch.name, b"",
        0, signature.encode(),
    )
    Py_INCREF(batch)
    (<PyUFuncObject *>ufunc).obj = <PyObject *>batch
    return ufunc


cdef struct Shape:
    int ndim, type
    np.npy_intp sizes[DIMENSIONS]
    Py_ssize_t bytes


cdef class Function:
    """A function of a kernel's library: ``call(*inputs, parameters=None, out=None)``.

    Aligned, contiguous arrays of the right type and just the right shapes go straight to C; others
    that need no check but of type and shapes, to ``gufunc``. All other calls go to ``general``, a
    Python function with the same arguments.
    """

    cdef readonly Library library
    cdef readonly str name
    cdef readonly object gufunc, general
    cdef object origin, defaults
    cdef bytes c_name, c_doc
    cdef PyMethodDef definition
    cdef Single single
    cdef int n_inputs, n_arguments
    cdef bint straight, parametric
    cdef Shape shapes[STRAIGHT]

    def __init__(self, Library library not None, str symbol, gufunc, str name, str doc, inputs,
                 outputs, parameters, general, origin, dtype):
        """Prepare the calls of a symbol of the library.

        ``inputs`` and ``outputs`` are shapes; ``parameters`` is None, or the number of run-time
        parameters and their defaults (an array, or None if one lacks a default). ``doc`` begins
        with the signature. ``dtype`` is float64 or float32. ``origin``, a function and its arguments, gives this object anew when
        it is unpickled.
        """
        self.library, self.gufunc, self.name = library, gufunc, name
        self.general, self.origin = general, origin
        self.single = <Single>library.symbol(symbol)
        shapes = [*inputs, *outputs]
        self.n_inputs = len(inputs)
        self.parametric = parameters is not None
        if self.parametric:
            count, defaults = parameters
            shapes.insert(self.n_inputs, (count,))
            self.n_inputs += 1
            if defaults is not None:
                self.defaults = numpy.array(defaults, dtype=dtype).reshape(count)
        self.n_arguments = len(shapes)
        self.straight = len(shapes) <= STRAIGHT and max(map(len, shapes)) <= DIMENSIONS
        if self.straight:
            for i, shape in enumerate(shapes):
                self.shapes[i].ndim = len(shape)
                self.shapes[i].type = _type_of(dtype)
                self.shapes[i].bytes = numpy.dtype(dtype).itemsize
                for axis, size in enumerate(shape):
                    self.shapes[i].sizes[axis] = size
                    self.shapes[i].bytes *= size
        self.c_name, self.c_doc = name.encode(), doc.encode()
        self.definition.ml_name = self.c_name
        self.definition.ml_meth = <PyCFunction>_call
        self.definition.ml_flags = METH_FASTCALL | METH_KEYWORDS
        self.definition.ml_doc = self.c_doc

    @property
    def call(self):
        """The function, as users call it."""
        return PyCFunction_New(&self.definition, self)

    def __getattr__(self, name):
        # a bound function is pickled as the attribute of its object
        if name == self.name:
            return self.call
        raise AttributeError(f"{type(self).__name__} has no attribute {name!r}")

    def __reduce__(self):
        return self.origin

    def __repr__(self):
        return f"Function({self.name!r} of {self.library.path!r})"


cdef inline bint _has_shape(PyObject *array, Shape *shape) noexcept:
    """Tell whether this is an array of just this type and shape, in C's memory layout."""
    cdef PyArrayObject *a = <PyArrayObject *>array
    cdef int axis
    if not PyArray_CheckExact(array) or PyArray_TYPE(a) != shape.type:
        return False
    if not PyArray_ISCARRAY_RO(a) or PyArray_NDIM(a) != shape.ndim:
        return False
    for axis in range(shape.ndim):
        if PyArray_DIMS(a)[axis] != shape.sizes[axis]:
            return False
    return True


cdef object _call(object self, PyObject **args, Py_ssize_t nargs, PyObject *keywords):
    """Call C if every argument fits it as it is, else the general function."""
    cdef Function function = <Function>self
    cdef PyObject *parameters = Py_None
    cdef PyObject *out = Py_None
    cdef PyObject *keyword
    cdef void *data[STRAIGHT]
    cdef Py_ssize_t i
    if keywords is not NULL:
        for i in range(PyTuple_GET_SIZE(keywords)):
            keyword = PyTuple_GET_ITEM(keywords, i)
            if PyUnicode_CompareWithASCIIString(keyword, "out") == 0:
                out = args[nargs + i]
            elif PyUnicode_CompareWithASCIIString(keyword, "parameters") == 0:
                parameters = args[nargs + i]
            else:
                return PyObject_Vectorcall(function.general, args, nargs, keywords)
    if function.straight and _read(function, args, nargs, parameters, data):
        if out == Py_None:
            return _new_results(function, data)
        if _write_to(function, out, data):
            moro_apply(function.single, function.n_arguments, data)
            return <object>out
    if function.straight and _broadcasts(function, args, nargs, parameters, out):
        return _many(function, args, nargs, parameters, out)
    return PyObject_Vectorcall(function.general, args, nargs, keywords)


cdef object _many(
    Function function, PyObject **args, Py_ssize_t nargs, PyObject *parameters, PyObject *out
):
    """Call the gufunc."""
    cdef PyObject *operands[STRAIGHT + 1]
    cdef Py_ssize_t i, n = nargs
    for i in range(nargs):
        operands[i] = args[i]
    if function.parametric:
        operands[n] = <PyObject *>function.defaults if parameters == Py_None else parameters
        n += 1
    if out != Py_None:
        operands[n] = out
        n += 1
    return PyObject_Vectorcall(function.gufunc, operands, n, NULL)


cdef bint _read(
    Function function, PyObject **args, Py_ssize_t nargs, PyObject *parameters, void **data
) noexcept:
    """Put the addresses of the inputs into ``data``, if C can read them."""
    cdef Py_ssize_t i, n = function.n_inputs - function.parametric
    if nargs != n:
        return False
    for i in range(n):
        if not _has_shape(args[i], &function.shapes[i]):
            return False
        data[i] = <void *>PyArray_DATA(<PyArrayObject *>args[i])
    if not function.parametric:
        return parameters == Py_None
    if parameters == Py_None:
        parameters = <PyObject *>function.defaults
    if not _has_shape(parameters, &function.shapes[n]):
        return False
    data[n] = <void *>PyArray_DATA(<PyArrayObject *>parameters)
    return True


cdef bint _broadcasts(
    Function function, PyObject **args, Py_ssize_t nargs, PyObject *parameters, PyObject *out
) noexcept:
    """Tell whether the arguments are arrays that a gufunc takes without complaint.

    The axes in front of those of one sample must be the same in all inputs, or missing; a result's
    memory must be apart from theirs.
    """
    cdef Py_ssize_t i, n = function.n_inputs - function.parametric
    cdef np.npy_intp *samples = NULL
    cdef int axes = 0, leading
    cdef PyObject *array
    if nargs != n or (parameters != Py_None and not function.parametric):
        return False
    if out != Py_None and (
        function.n_arguments - function.n_inputs != 1
        or _samples_axes(out, &function.shapes[function.n_inputs]) < 0
        or not PyArray_ISBEHAVED(<PyArrayObject *>out)
    ):
        return False
    for i in range(function.n_inputs):
        if i < n:
            array = args[i]
        else:
            array = <PyObject *>function.defaults if parameters == Py_None else parameters
        leading = _samples_axes(array, &function.shapes[i])
        if leading < 0 or (out != Py_None and _meet(array, out)):
            return False
        if leading > 0:
            if samples is NULL:
                samples, axes = PyArray_DIMS(<PyArrayObject *>array), leading
            if not _begins_with(array, leading, samples, axes):
                return False
    if out == Py_None:
        return True
    leading = _samples_axes(out, &function.shapes[function.n_inputs])
    return _begins_with(out, leading, samples, axes) and _is_spread(out)


cdef inline int _samples_axes(PyObject *array, Shape *shape) noexcept:
    """Return how many axes of an array of the right type come before those of one sample, or -1."""
    cdef PyArrayObject *a = <PyArrayObject *>array
    cdef int axis, leading
    if not PyArray_CheckExact(array) or PyArray_TYPE(a) != shape.type:
        return -1
    leading = PyArray_NDIM(a) - shape.ndim
    for axis in range(shape.ndim):
        if leading < 0 or PyArray_DIMS(a)[leading + axis] != shape.sizes[axis]:
            return -1
    return leading


cdef inline bint _begins_with(
    PyObject *array, int leading, np.npy_intp *samples, int axes
) noexcept:
    """Tell whether the axes in front are just those of the samples."""
    cdef int axis
    if leading != axes:
        return False
    for axis in range(axes):
        if PyArray_DIMS(<PyArrayObject *>array)[axis] != samples[axis]:
            return False
    return True


cdef bint _meet(PyObject *one, PyObject *other) noexcept:
    """Tell whether two arrays reach into each other, from their first to their last bytes."""
    cdef char *first[2]
    cdef char *end[2]
    cdef PyArrayObject *a
    cdef int k, axis
    cdef np.npy_intp reach
    for k in range(2):
        a = <PyArrayObject *>(other if k else one)
        first[k] = <char *>PyArray_DATA(a)
        end[k] = first[k] + PyArray_ITEMSIZE(a)
        for axis in range(PyArray_NDIM(a)):
            reach = PyArray_STRIDES(a)[axis] * (PyArray_DIMS(a)[axis] - 1)
            if reach > 0:
                end[k] += reach
            else:
                first[k] += reach
    return first[0] < end[1] and first[1] < end[0]


cdef bint _is_spread(PyObject *array) noexcept:
    """Tell whether every axis steps beyond all that the shorter steps reach: no byte is two's."""
    cdef PyArrayObject *a = <PyArrayObject *>array
    cdef int axis, other
    cdef np.npy_intp step, shorter, reach
    for axis in range(PyArray_NDIM(a)):
        if PyArray_DIMS(a)[axis] <= 1:
            continue
        step = abs(PyArray_STRIDES(a)[axis])
        reach = PyArray_ITEMSIZE(a)
        for other in range(PyArray_NDIM(a)):
            shorter = abs(PyArray_STRIDES(a)[other])
            if shorter < step or (shorter == step and other > axis):
                reach += shorter * (PyArray_DIMS(a)[other] - 1)
        if step < reach:
            return False
    return True


cdef bint _write_to(Function function, PyObject *out, void **data) noexcept:
    """Put the addresses of the results into ``data``, if C can write there."""
    cdef Py_ssize_t i, n = function.n_arguments - function.n_inputs
    if n == 1:
        return _write_to_one(function, function.n_inputs, out, data)
    if not PyTuple_CheckExact(out) or PyTuple_GET_SIZE(out) != n:
        return False
    for i in range(n):
        if not _write_to_one(function, function.n_inputs + i, PyTuple_GET_ITEM(out, i), data):
            return False
    return True


cdef inline bint _write_to_one(
    Function function, Py_ssize_t k, PyObject *out, void **data
) noexcept:
    """The same for the k-th argument: no byte of it may belong to an argument before it."""
    cdef Py_ssize_t i
    cdef char *start
    if not _has_shape(out, &function.shapes[k]) or not PyArray_ISCARRAY(<PyArrayObject *>out):
        return False
    data[k] = <void *>PyArray_DATA(<PyArrayObject *>out)
    start = <char *>data[k]
    for i in range(k):
        if (start < <char *>data[i] + function.shapes[i].bytes
                and <char *>data[i] < start + function.shapes[k].bytes):
            return False
    return True


cdef object _new_results(Function function, void **data):
    """Call C with new arrays for the results: an array, or a tuple of them."""
    cdef Py_ssize_t i, n = function.n_arguments - function.n_inputs
    cdef Shape *shape = &function.shapes[function.n_inputs]
    cdef list results
    if n == 1:
        result = PyArray_EMPTY(shape.ndim, shape.sizes, shape.type, 0)
        data[function.n_inputs] = <void *>PyArray_DATA(<PyArrayObject *><PyObject *>result)
        moro_apply(function.single, function.n_arguments, data)
        return result if shape.ndim else result[()]
    results = []
    for i in range(n):
        result = PyArray_EMPTY(shape[i].ndim, shape[i].sizes, shape.type, 0)
        data[function.n_inputs + i] = <void *>PyArray_DATA(<PyArrayObject *><PyObject *>result)
        results.append(result)
    moro_apply(function.single, function.n_arguments, data)
    return tuple([result if result.ndim else result[()] for result in results])
