"""Inner functions of compiled code as parts: linked once, optimised once with their entry.

Numba optimises each function and turns it into machine code of its own; its callers take in
what they call and do that again. Here a function that compiled code calls stays a part, LLVM
code as it comes from Numba's lowering. What Python calls is an entry: it links each part that
it reaches once, and the whole is optimised and translated once.

This module alone changes how Numba works inside (code libraries, compiler flags); see
``TESTED`` in :mod:`toothspace.core.compilation.decorators` for the versions that it works with.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, final

import llvmlite.binding as llvm
from numba.core import compiler, sigutils
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler_lock import global_compiler_lock, require_global_compiler_lock
from numba.core.environment import lookup_environment
from numba.core.registry import CPUDispatcher
from numba.core.targetconfig import ConfigStack

from toothspace.core.compilation.cache import EntryCache
from toothspace.core.compilation.notice import NOTICE

_ENVIRONMENT = "_ZN08NumbaEnv"
_INHERITED = ("fastmath", "error_model", "nrt")


class _Library(JITCodeLibrary):  # type: ignore[misc]
    """Code library that leaves all optimisation to the entry."""

    def add_llvm_module(self, module: Any) -> None:
        module.data_layout = self._codegen._data_layout
        self._final_module.link_in(module)

    def linked(self) -> tuple[list[PartLibrary], list[Any]]:
        """Parts that this library reaches, callers first, and Numba's own libraries."""
        parts: dict[PartLibrary, None] = {}
        others: dict[Any, None] = {}
        ahead = [*self._linking_libraries]
        while ahead:
            library = ahead.pop()
            if not isinstance(library, PartLibrary):
                others[library] = None
            elif library not in parts:
                parts[library] = None
                ahead += library._linking_libraries
        return list(parts), list(others)


@final
class PartLibrary(_Library):
    """Code of a function that only compiled code calls, neither optimised nor translated."""

    def finalize(self) -> None:
        """Leave the code as it is."""
        require_global_compiler_lock()
        self._raise_if_finalized()
        self._finalize_dynamic_globals()
        self._finalized = True

    def _get_module_for_linking(self) -> Any:
        """Code with all parts that it reaches, for libraries that Numba links itself."""
        shared = getattr(self, "_shared_module", None)
        if shared is None:
            module = self._final_module.clone()
            parts, others = self.linked()
            _link(module, parts, others)
            for function in _defined(module):
                if function.linkage == llvm.Linkage.external:
                    function.linkage = "linkonce_odr"
            self._shared_module = shared = module
        return shared


@final
class EntryLibrary(_Library):
    """Code that Python calls, with all parts that it reaches."""

    def finalize(self) -> None:
        """Link all parts, optimise the whole and translate it."""
        require_global_compiler_lock()
        self._codegen._check_llvm_bugs()
        self._raise_if_finalized()
        module = self._final_module
        own = {function.name for function in _defined(module)}
        parts, others = self.linked()
        for library in (*parts, *others):
            self._reload_init.update(library._reload_init)
        _link(module, parts, others)
        inner = {f.name for part in parts for f in _defined(part._final_module)} - own
        for function in _defined(module):
            if function.name in inner:
                # without a symbol: the loader would take it for the part of another entry
                function.linkage = "private"
        self._optimize_final_module()
        module.verify()
        self._finalize_final_module()

    def _optimize_final_module(self) -> None:
        """Run LLVM's passes, the cheap ones before only where references are counted."""
        if any(function.name == "NRT_incref" for function in self._final_module.functions):
            self._optimize_functions(self._final_module)
            super()._optimize_final_module()
            return
        manager, builder = self._codegen._module_pass_manager()
        with self._recorded_timings.record("Module passes", builder):
            manager.run(self._final_module, builder)


def _defined(module: Any) -> Iterator[Any]:
    return (function for function in module.functions if not function.is_declaration)


def _link(module: Any, parts: list[PartLibrary], others: list[Any]) -> None:
    for part in parts:
        module.link_in(part._final_module, preserve=True)
    # shared code of Numba is taken in only where something asks for it, so it comes last
    for library in others:
        module.link_in(library._get_module_for_linking(), preserve=True)


@final
class _PartCompiler(compiler.Compiler):  # type: ignore[misc]
    """Numba's pipeline, ending with a part."""

    def define_pipelines(self) -> Any:
        state = self.state
        state.flags.no_cpython_wrapper = state.flags.no_cfunc_wrapper = True
        state.flags.no_compile = True
        state.library = PartLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        return super().define_pipelines()


@final
class _EntryCompiler(compiler.Compiler):  # type: ignore[misc]
    """Numba's pipeline, ending with an entry."""

    def define_pipelines(self) -> Any:
        state = self.state
        state.flags.no_cfunc_wrapper = True
        state.library = EntryLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return super().define_pipelines()


@final
class _Part(CPUDispatcher):  # type: ignore[misc]
    """Parts of one function, one for each signature."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        super().__init__(function, {}, options, _PartCompiler)

    def compile(self, sig: Any) -> Any:
        with global_compiler_lock, self._compiling_counter:
            args, return_type = sigutils.normalize_signature(sig)
            existing = self.overloads.get(tuple(args))
            if existing is None:
                NOTICE.step()
                result = self._compiler.compile(args, return_type)
                existing = result._replace(entry_point=object())
                self.targetctx.insert_user_function(
                    existing.entry_point, existing.fndesc, [existing.library]
                )
                self.overloads[tuple(args)] = existing
            return existing.entry_point


class _Parts:
    """Parts of one function under the options that its callers hand on."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        self._function = function
        # what is not asked for must not depend on who calls first
        self._options = {"nopython": True, "forceinline": False, **options}
        asked = {name.lstrip("_") for name in options}
        self._inherited = [name for name in _INHERITED if name not in asked]
        self._made: dict[Any, _Part] = {}

    def chosen(self) -> _Part:
        """Parts for the function that is being compiled."""
        caller = ConfigStack.top_or_none()
        key = None if caller is None else tuple(str(getattr(caller, n)) for n in self._inherited)
        if key not in self._made:
            self._made[key] = _Part(self._function, self._options)
        return self._made[key]


@final
class Kernel(CPUDispatcher):  # type: ignore[misc]
    """Compiled function: an entry where Python calls it, a part where compiled code does."""

    def __init__(
        self,
        py_func: Callable[..., Any],
        locals: dict[str, Any] | None = None,
        targetoptions: dict[str, Any] | None = None,
        pipeline_class: Any = _EntryCompiler,
    ) -> None:
        options = dict(targetoptions or {})
        self._parts = _Parts(py_func, options)
        super().__init__(py_func, locals, {"nopython": True, **options}, pipeline_class)
        self._cache = EntryCache(py_func, options)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Compile the part for a call in compiled code and give its type."""
        return self._parts.chosen().get_call_template(args, kws)

    def get_overload(self, sig: Any) -> Any:
        """Give the part of a signature."""
        return self._parts.chosen().get_overload(sig)

    def compile(self, sig: Any) -> Any:
        """Load or compile the entry of a signature."""
        with global_compiler_lock, NOTICE.making_ready(self.py_func):
            return super().compile(sig)

    def add_overload(self, result: Any) -> None:
        """Keep an entry; what its parts need of Python must be set in its code."""
        for variable in result.library._final_module.global_variables:
            if variable.name.startswith(_ENVIRONMENT) and not variable.is_declaration:
                environment = lookup_environment(variable.name)
                if environment is not None:
                    result.library.codegen.set_env(variable.name, environment)
        super().add_overload(result)


@final
class Formula(CPUDispatcher):  # type: ignore[misc]
    """What compiled code calls in place of a plain function."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._parts = _Parts(function, {})
        super().__init__(function, {}, {"nopython": True}, _PartCompiler)
        self.typingctx.insert_global(function, self._type)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Compile the part for a call in compiled code and give its type."""
        return self._parts.chosen().get_call_template(args, kws)

    def get_overload(self, sig: Any) -> Any:
        """Give the part of a signature."""
        return self._parts.chosen().get_overload(sig)
