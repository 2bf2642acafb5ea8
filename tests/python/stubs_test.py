"""The stubs of the native module have its names and signatures; everything public has a docstring and annotations.

usage: stubs_test.py
"""
import ast
import inspect
import pathlib
import re
import unittest

import tactree
from tactree import _native

STUB = ast.parse((pathlib.Path(tactree.__file__).parent / "_native.pyi").read_text())


def stub_signature(function):
    """[name of the parameter, has a default], without self."""
    arguments = function.args
    assert not arguments.kwonlyargs and not arguments.vararg and not arguments.kwarg, function.name
    required = len(arguments.args) - len(arguments.defaults)
    return [(a.arg, i >= required) for i, a in enumerate(arguments.args) if a.arg != "self"]


def native_signature(function):
    """From the first line of the docstring, which pybind11 writes."""
    line = function.__doc__.splitlines()[0]
    parameters = re.search(r"\((.*)\) ->", line)[1]
    # A parameter begins with its name and a colon, outside of brackets.
    depth, parts = 0, [""]
    for c in parameters:
        depth += (c in "([{") - (c in ")]}")
        if c == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += c
    found = [(part.split(":")[0].strip(), " = " in part) for part in parts if part.strip()]
    return [(name, default) for name, default in found if name != "self"]


def is_property(node):
    return any(isinstance(d, ast.Name) and d.id == "property" for d in node.decorator_list)


def public(names):
    return {name for name in names if not name.startswith("_")}


class Stubs(unittest.TestCase):
    def names_of_stub(self, kind):
        return {node.name: node for node in STUB.body if isinstance(node, kind)}

    def test_names(self):
        variables = {node.target.id for node in STUB.body if isinstance(node, ast.AnnAssign)}
        functions, classes = self.names_of_stub(ast.FunctionDef), self.names_of_stub(ast.ClassDef)
        self.assertEqual(public({*variables, *functions, *classes}), public(dir(_native)))
        for name in functions:
            self.assertTrue(inspect.isbuiltin(getattr(_native, name)), name)
        for name in classes:
            self.assertTrue(inspect.isclass(getattr(_native, name)), name)

    def test_signatures_of_functions(self):
        for name, node in self.names_of_stub(ast.FunctionDef).items():
            self.assertEqual(stub_signature(node), native_signature(getattr(_native, name)), name)

    def test_classes(self):
        for name, node in self.names_of_stub(ast.ClassDef).items():
            native = getattr(_native, name)
            members = {member.name: member for member in node.body if isinstance(member, ast.FunctionDef)}
            if issubclass(native, Exception):
                self.assertEqual([base.id for base in node.bases], [native.__base__.__name__])
                continue
            self.assertEqual(public(members), public(vars(native)), name)
            for member, definition in members.items():
                value = vars(native)[member]
                if is_property(definition):
                    self.assertIsInstance(value, property, f"{name}.{member}")
                    self.assertTrue(value.__doc__, f"{name}.{member}")
                else:
                    self.assertEqual(stub_signature(definition), native_signature(value), f"{name}.{member}")


class Public(unittest.TestCase):
    def members(self):
        for name in tactree.__all__:
            value = getattr(tactree, name)
            yield name, value
            if inspect.isclass(value) and value.__module__.startswith("tactree."):
                for member, inner in vars(value).items():
                    if not member.startswith("_") or member == "__init__":
                        yield f"{name}.{member}", getattr(inner, "__func__", inner)

    def test_everything_has_docstring(self):
        count = 0
        for name, value in self.members():
            if callable(value) or isinstance(value, property):
                count += 1
                if name != "Model.__init__":  # only the functions of the package create one
                    self.assertTrue((inspect.getdoc(value) or "").strip(), name)
        self.assertGreater(count, 60)

    def test_everything_is_annotated(self):
        for name, value in self.members():
            function = value.fget if isinstance(value, property) else value
            if inspect.isfunction(function):
                signature = inspect.signature(function)
                for parameter in signature.parameters.values():
                    if parameter.name not in ("self", "cls"):
                        self.assertIsNot(parameter.annotation, parameter.empty, f"{name}: {parameter}")
                if not name.endswith("__init__"):
                    self.assertIsNot(signature.return_annotation, signature.empty, name)

    def test_package_exports_listed_names(self):
        self.assertTrue((pathlib.Path(tactree.__file__).parent / "py.typed").exists())
        exported = {name for name in vars(tactree) if not name.startswith("_")}
        self.assertEqual(exported - {"annotations"}, public(tactree.__all__))
        self.assertEqual(sorted(tactree.__all__), sorted(set(tactree.__all__)))


if __name__ == "__main__":
    unittest.main(verbosity=2)
