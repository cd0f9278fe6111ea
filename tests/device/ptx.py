"""PTX -> C++, with ptx.h: so a processor executes what the driver of a card would get, one item after the other.

ptx.py PTX C++: a kernel becomes a function of the addresses of its arguments, as cuLaunchKernel has them; registers are
variables, branches are gotos. An operation on floats that may be fused, or is not correctly rounded, is an error."""
import re
import sys

TYPES = {"pred": "bool", "f32": "float", "f64": "double"}
for n in (8, 16, 32, 64):
    TYPES |= {f"{kind}{n}": f"{'' if kind == 's' else 'u'}int{n}_t" for kind in "bsu"}
# Operations that are functions of their operands, which have the type of the result; and those of floats that round.
PLAIN = "add sub mul div rem neg min max and or xor not selp brev abs".split()
RENAMED = {"min", "max", "and", "or", "xor", "not", "abs", "sqrt"}
ROUNDED = {"add", "sub", "mul", "div", "rcp", "sqrt"}
COMPARISONS = {"lt": "<", "le": "<=", "gt": ">", "ge": ">=", "eq": "==", "ne": "!=", "lo": "<", "ls": "<=", "hi": ">", "hs": ">="}
TO_WHOLE = {"rmi": "std::floor", "rzi": "std::trunc", "rpi": "std::ceil", "rni": "std::nearbyint"}


def name(word):
    """A register, label or variable as a name of C++. Registers are arrays: names by the thousand take a compiler long."""
    if word in ("%clock64", "%globaltimer"):
        return "clock64()"
    numbered = re.fullmatch(r"%([a-z]+)(\d+)", word)
    return f"_{numbered[1]}[{numbered[2]}]" if numbered else re.sub(r"\W", "_", word)


def value(word, ty):
    """An operand as a number of a type."""
    if word.startswith("0f") or word.startswith("0d"):
        return f"as<{TYPES[ty]}>({'uint32_t' if word[1] == 'f' else 'uint64_t'}(0x{word[2:]}u))"
    if re.match(r"-?\d", word):
        return f"({TYPES[ty]}){word}ll"
    if word.startswith("%"):
        return f"as<{TYPES[ty]}>({name(word)})"
    return f"(Address){name(word)}"


def address(word):
    """`[register+offset]`"""
    base, offset = re.fullmatch(r"\[([%$\w]+)((?:[+]-?\d+)?)\]", word).groups()
    return f"as<Address>({name(base)}){offset}"


def size(ty):
    return int(ty[1:]) // 8


def operation(words, args):
    """The statement of an operation, by the parts of its name and its operands."""
    op, ty = words[0], words[-1]
    cpp = TYPES.get(ty)
    to = name(args[0]) if args else ""
    numbers = [value(arg, ty) for arg in args[1:]] if cpp and op not in ("ld", "st") else []
    if ty in ("f32", "f64") and op in ROUNDED and words[1:-1] != ["rn"]:
        raise SystemExit(f"not rounded by itself: {'.'.join(words)}")
    if op in ("ld", "st"):
        at, registers = (args[1], args[0]) if op == "ld" else (args[0], args[1])
        registers = re.findall(r"[^{},\s]+", registers)
        at = [f"{address(at)} + {i * size(ty)}" for i in range(len(registers))]
        if op == "ld":
            return " ".join(f"set({name(r)}, load<{cpp}>({a}));" for r, a in zip(registers, at))
        return " ".join(f"store<{cpp}>({a}, {value(r, ty)});" for r, a in zip(registers, at))
    if op == "cvta" or op == "mov":
        return f"set({to}, {numbers[0]});"
    if op == "setp":
        a, b = numbers
        comparison = words[1]
        if comparison in ("num", "nan"):
            return f"{to} = {'!' if comparison == 'num' else ''}({a} != {a} || {b} != {b});"
        is_unordered = comparison not in COMPARISONS
        other = f" || {a} != {a} || {b} != {b}" if is_unordered else ""
        return f"{to} = {a} {COMPARISONS[comparison.removesuffix('u') if is_unordered else comparison]} {b}{other};"
    if op == "cvt":
        of, number = words[-1], numbers[0]
        for whole in set(words) & set(TO_WHOLE):
            number = f"{TO_WHOLE[whole]}({number})"
        return f"set({to}, converted<{TYPES[words[-2]]}>({number}));"
    if op == "mul" and words[1] == "wide" or op == "mad" and words[1] == "wide":
        wide = TYPES[f"{ty[0]}{2 * int(ty[1:])}"]
        plus = f" + {value(args[3], f'{ty[0]}{2 * int(ty[1:])}')}" if op == "mad" else ""
        return f"set({to}, ({wide})(({wide}){numbers[0]} * ({wide}){numbers[1]}{plus}));"
    if op in ("mul", "mad") and words[1] == "hi":
        raise SystemExit(f"not translated: {'.'.join(words)}")
    if op in ("shl", "shr"):
        return f"set({to}, {op}<{cpp}>({numbers[0]}, {value(args[2], 'u32')}));"
    if op in ("bfi", "bfe"):
        n = 2 if op == "bfi" else 1
        rest = [value(arg, "u32") for arg in args[1 + n:]]
        return f"set({to}, {op}<{cpp}>({', '.join(numbers[:n] + rest)}));"
    if op == "selp":
        numbers[2] = value(args[3], "pred")
    if op in PLAIN or op in ("mad", "rcp", "sqrt", "prmt", "popc", "clz"):
        function = f"{op}_of" if op in RENAMED else op
        return f"set({to}, {function}<{cpp}>({', '.join(numbers)}));"
    raise SystemExit(f"not translated: {'.'.join(words)}")


def statement(text):
    """A statement of PTX as one of C++."""
    if found := re.fullmatch(r"\.reg \.(\w+)\s+%(\w+)<(\d+)>", text):
        ty, stem, n = found.groups()
        return f"{TYPES[ty]} _{stem}[{n}];"
    if found := re.fullmatch(r"\.reg \.(\w+)\s+(%?\w+)", text):
        return f"{TYPES[found[1]]} {name(found[2])};"
    if found := re.fullmatch(r"\.(?:local|param) (?:\.align (\d+) )?\.(\w+)\s+(\w+)(?:\[(\d+)\])?", text):
        align, ty, variable, n = found.groups()
        return f"alignas({align or size(ty)}) char {variable}[{int(n or 1) * size(ty)}];"
    if text.startswith("call"):
        result, function, args = re.fullmatch(r"call(?:\.uni)?\s+(?:\((\w+)\)\s*,\s*)?(\w+)\s*(?:,\s*\(([^)]*)\))?", text).groups()
        args = re.findall(r"\w+", args or "")
        return f"{name(function)}({', '.join([result] * bool(result) + args)});"
    condition, words, args = re.fullmatch(r"(?:@(!?%\w+)\s+)?([\w.]+)\s*(.*)", text, re.S).groups()
    words = words.split(".")
    args = re.findall(r"\{[^}]*\}|\[[^\]]*\]|[^,\s]+", args)
    if words[0] == "bra":
        result = f"goto {name(args[0])};"
    elif words[0] in ("ret", "exit"):
        result = "return;"
    else:
        result = operation(words, args)
    return f"if ({'!' * condition.startswith('!')}{name(condition.lstrip('!'))}) {{ {result} }}" if condition else result


def function(header, body):
    """A function or a kernel; its parameters are memory."""
    kind, result, title, parameters = re.fullmatch(
        r"(?:\.\w+ )?\.(entry|func)\s*(?:\((.*?)\)\s*)?([\w$]+)\s*\((.*)\)\s*", header, re.S).groups()
    parameters = re.findall(r"\.param [^,]*?(\w+)(?:\[\d+\])?\s*(?:,|$)", parameters.strip())
    if kind == "entry":
        lines = [f"static void item_{title}(void **arguments) {{"]
        lines += [f"char *{parameter} = (char *)arguments[{i}];" for i, parameter in enumerate(parameters)]
    else:
        results = re.findall(r"(\w+)(?:\[\d+\])?$", result.strip()) if result else []
        lines = [f"static void {name(title)}({', '.join(f'char *{p}' for p in results + parameters)}) {{"]
    pending = ""
    for line in body.split("\n"):
        line = line.split("//")[0].strip()
        if not pending and line in "{}":
            lines.append(line)
        elif not pending and re.fullmatch(r"[$\w]+:", line):
            lines.append(f"{name(line[:-1])}:;")
        else:
            *complete, pending = f"{pending} {line}".split(";")
            lines += [statement(text.strip()) for text in complete]
            pending = pending.strip()
    if kind == "entry":
        call = f"launch(item_{title}, arguments, n_groups, group);"
        lines += ["}", f'extern "C" void {title}(void **arguments, unsigned n_groups, unsigned group) {{ {call} ']
    return lines + ["}"]


ptx = open(sys.argv[1], encoding="utf-8").read()
cpp = ['#include "ptx.h"']
for found in re.finditer(r"^\.(?:const|global) \.align (\d+) \.(\w+) (\w+)\[(\d+)\](?: = \{(.*?)\})?;", ptx, re.M | re.S):
    align, ty, variable, n, words = found.groups()
    cpp.append(f"alignas({align}) static {TYPES[ty]} {variable}[{n}] = {{{words or ''}}};")
for found in re.finditer(r"^((?:\.visible |\.weak )?\.(?:entry|func)\b[^;{]*)^\{\n(.*?)^\}$", ptx, re.M | re.S):
    cpp += function(found[1].strip(), found[2])
open(sys.argv[2], "w", encoding="utf-8").write("\n".join(cpp) + "\n")
