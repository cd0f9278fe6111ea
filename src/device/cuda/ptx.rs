//! PTX in which each operation on floats is rounded by itself, as IEEE 754 says.

/// The version of PTX that the driver is asked for, of CUDA 11.0: so it may be older than the
/// compiler. Programs use nothing that is newer but hints of this name, which may be left out.
const VERSION: &str = ".version 7.0";
const NEW_HINT: &str = ".pragma \"used_bytes_mask";

/// Returns PTX for the driver. It may fuse products and sums that have no mode of rounding (PTX ISA,
/// "Floating Point Instructions: add"), so they get the default one, `.rn`.
///
/// # Errors
/// The text has an operation on floats that is neither exact nor rounded to the nearest number.
pub(super) fn exact(ptx: &str) -> Result<String, String> {
    let is_hint = |line: &&str| line.trim_start().starts_with(NEW_HINT);
    let lines = ptx.lines().filter(|line| !is_hint(line));
    lines.map(|line| Ok(exact_line(line)? + "\n")).collect()
}

fn exact_line(line: &str) -> Result<String, String> {
    if line.starts_with(".version ") {
        return Ok(VERSION.to_owned());
    }
    // A line has at most one operation, which may have a condition: `@%p1 bra`.
    let mut words = line.split_whitespace();
    let operation = words.find(|word| !word.starts_with('@')).unwrap_or("");
    let parts: Vec<_> = operation.split('.').collect();
    let is_float = |part: &&str| part.starts_with("f32") || part.starts_with("f64");
    if parts[0].is_empty() || !parts[1..].iter().any(is_float) {
        return Ok(line.to_owned());
    }
    let is_inexact = |part: &&str| ["approx", "ftz", "full", "sat"].contains(part);
    match parts[..] {
        [name @ ("add" | "sub" | "mul"), ty] => {
            Ok(line.replacen(operation, &format!("{name}.rn.{ty}"), 1))
        }
        ["add" | "sub" | "mul" | "div" | "rcp" | "sqrt", "rn", ..]
        | [
            "abs" | "copysign" | "cvt" | "ld" | "max" | "min" | "mov" | "neg" | "selp" | "setp"
            | "st",
            ..,
        ] if !parts.iter().any(is_inexact) => Ok(line.to_owned()),
        _ => Err(format!("`{operation}` is not rounded as IEEE 754 says")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_products_are_rounded_one_by_one() {
        let ptx = "//\n.version 9.5\n.target sm_75\n.visible .entry path(\n\t.param .f32 x\n)\n{\n\t\
            .reg .f32 \t%f<9>;\n$L__BB0_1:\n\tmul.f32 \t%f3, %f1, %f2;\n\
            \t@!%p1 add.f32 %f4, %f3, 0f3F800000;\n\tsub.rn.f64 %fd1, %fd2, %fd3;\n\tadd.s32 %r1, %r2, %r3;\n\
            \tdiv.rn.f32 %f5, %f4, %f3;\n\tld.global.v4.f32 {%f6, %f7, %f8, %f9}, [%rd1];\n\
            \tcvt.rzi.u32.f32 %r1, %f5;\n\tsetp.lt.f32 %p1, %f1, %f2;\n}\n";
        let hint = "\t.pragma \"used_bytes_mask 4095\";\n\tld.global.v4";
        assert_eq!(exact(&ptx.replace("\tld.global.v4", hint)), exact(ptx));
        let expected = ptx
            .replace("9.5", "7.0")
            .replace("\tmul.f32", "\tmul.rn.f32")
            .replace("add.f32", "add.rn.f32");
        assert_eq!(exact(ptx), Ok(expected));
    }

    #[test]
    fn other_arithmetic_is_refused() {
        let operations = "fma.rn.f32 mad.f64 mul.rz.f32 add.ftz.f32 add.rn.ftz.f32 div.full.f32 \
            div.approx.f32 sqrt.approx.ftz.f32 rsqrt.approx.f32 ex2.approx.f32 \
            cvt.rn.sat.f32.s32 setp.lt.ftz.f32";
        for operation in operations.split(' ') {
            let refused = exact(&format!("\t{operation} \t%f1, %f2, %f3;\n"));
            let expected = format!("`{operation}` is not rounded as IEEE 754 says");
            assert_eq!(refused, Err(expected));
        }
    }
}
