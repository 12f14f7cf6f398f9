"""Kernels that were compiled before are loaded without what only compiling others needs.

With a kernel's code numba keeps its LLVM bitcode, for kernels that are compiled later to take it in, and parses that
when the kernel is loaded: more than half of the time and memory that loading takes (numba.core.codegen,
`CPUCodeLibrary`). Where all kernels are kept nobody asks for it. Here it is parsed once somebody does.
"""

from llvmlite import binding
from numba.core import codegen

NEEDED = (
    "enable_object_caching",
    "get_pointer_to_function",
    "_finalize_final_module",
    "_get_module_for_linking",
    "_set_compiled_object",
    "_unserialize",
)
"""What numba's libraries must have for theirs to be loaded so; it is promised to nobody."""


class UnparsedLibrary(codegen.JITCodeLibrary):
    """A compiled library as numba has it, but for bitcode that was kept, which is parsed when it is asked for."""

    _object = None
    _bitcode = None

    @classmethod
    def _unserialize(cls, codegen, state):
        name, kind, data = state
        if kind != "object" or len(data) != 2:
            return super()._unserialize(codegen, state)
        library = codegen.create_library(name)
        library._object, library._bitcode = data
        library.enable_object_caching()
        library._set_compiled_object(library._object)
        library._finalize_final_module()
        return library

    def get_pointer_to_function(self, name):
        """Where a function's code begins; 0: the library has none of this name."""
        engine = self._codegen._engine
        if self._object is None or engine.is_symbol_defined(name):
            return super().get_pointer_to_function(name)
        # the names of symbols stand in object code, a zero behind each
        return engine.get_function_address(name) if name.encode() + b"\0" in self._object else 0

    def _get_module_for_linking(self):
        if self._bitcode is not None:
            self._shared_module = binding.parse_bitcode(self._bitcode)
            self._codegen._engine._load_defined_symbols(self._shared_module)
            self._object = self._bitcode = None
        return super()._get_module_for_linking()


def load_unparsed():
    """Libraries that are loaded from now on in this process are of this kind.

    Where a numba to come is made otherwise they stay as it has them: that is slower, and the tests of this say so.
    """
    if all(hasattr(codegen.JITCodeLibrary, name) for name in NEEDED):
        codegen.JITCPUCodegen._library_class = UnparsedLibrary
