//! Simulation of a compiler that treats floats as real numbers. The compiler reads functions of a kernel as parsed by
//! naga, simplifies each sum, and evaluates sums in any order. `opaque`, an exclusive or with an unknown zero, prevents
//! simplification.

use std::collections::{BTreeMap, HashMap};

use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{
    BinaryOperator, Expression, Function, Handle, Literal, Module, ScalarKind, Statement,
    TypeInner, UnaryOperator,
};

use support::SplitMix64;

/// A sum of products. Each product is a list of atoms, by index, with a coefficient.
type Sum = BTreeMap<Vec<usize>, f64>;

/// A factor that the simulated compiler cannot simplify.
#[derive(Clone, Debug, PartialEq)]
enum Atom {
    /// A function argument, or a buffer element.
    Input(String),
    /// A rounded sum passed through `opaque`.
    Opaque(Sum),
    /// The bits of a rounded sum that a mask has.
    Masked(Sum, u32),
}

#[derive(Clone, Debug)]
enum Value {
    Floats(Vec<Sum>),
    /// Bits of floats. `hidden` is true after the exclusive or with the zero known only at run time.
    Bits {
        floats: Vec<Sum>,
        hidden: bool,
    },
    /// Bits of floats that a mask has.
    MaskedBits {
        floats: Vec<Sum>,
        mask: u32,
    },
    /// An integer or a memory location, as text.
    Word(String),
}

/// The simplified results of a kernel's function.
pub(crate) struct Program {
    results: Vec<Sum>,
    atoms: Vec<Atom>,
}

impl Program {
    pub(crate) fn new(wgsl: &str, function: &str) -> Self {
        let module = naga::front::wgsl::parse_str(wgsl).unwrap_or_else(|e| {
            panic!("{}", e.emit_to_string(wgsl));
        });
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        let info = validator.validate(&module).unwrap();
        let mut reader = Reader { module: &module, info: &info, atoms: Vec::new() };
        let named = |f: &Function| f.name.as_deref() == Some(function);
        let (handle, function) = module.functions.iter().find(|(_, f)| named(f)).unwrap();
        let arguments = function
            .arguments
            .iter()
            .map(|argument| {
                reader.input(&module.types[argument.ty].inner, argument.name.as_ref().unwrap())
            })
            .collect();
        let Value::Floats(results) = reader.call(handle, arguments) else {
            panic!("no floats are returned");
        };
        Self { results, atoms: reader.atoms }
    }

    /// Evaluates the results, in a new random order at each call.
    pub(crate) fn evaluate(&self, input: &dyn Fn(&str) -> f32, rng: &mut SplitMix64) -> Vec<f32> {
        let mut known = HashMap::new();
        self.results.iter().map(|sum| self.sum(sum, input, rng, &mut known)).collect()
    }

    fn sum(
        &self,
        sum: &Sum,
        input: &dyn Fn(&str) -> f32,
        rng: &mut SplitMix64,
        known: &mut HashMap<usize, f32>,
    ) -> f32 {
        let mut terms: Vec<f64> = sum
            .iter()
            .map(|(atoms, &coefficient)| {
                let factors = atoms.iter().map(|&atom| self.atom(atom, input, rng, known));
                let product = factors.fold(coefficient, |product, x| product * f64::from(x));
                // The product may be rounded separately, or fused with the addition.
                if rng.below(2) == 0 { f64::from(product as f32) } else { product }
            })
            .collect();
        while terms.len() > 1 {
            let one = terms.swap_remove(rng.below(terms.len()));
            let other = terms.swap_remove(rng.below(terms.len()));
            terms.push(f64::from((one + other) as f32));
        }
        terms.first().map_or(0.0, |&x| x as f32)
    }

    fn atom(
        &self,
        atom: usize,
        input: &dyn Fn(&str) -> f32,
        rng: &mut SplitMix64,
        known: &mut HashMap<usize, f32>,
    ) -> f32 {
        if let Some(&x) = known.get(&atom) {
            return x;
        }
        let x = match &self.atoms[atom] {
            Atom::Input(name) => input(name),
            Atom::Opaque(sum) => self.sum(sum, input, rng, known),
            Atom::Masked(sum, mask) => {
                f32::from_bits(self.sum(sum, input, rng, known).to_bits() & mask)
            }
        };
        known.insert(atom, x);
        x
    }
}

/// Parser of a function, which follows calls and accepts expressions without branches.
struct Reader<'m> {
    module: &'m Module,
    info: &'m ModuleInfo,
    atoms: Vec<Atom>,
}

type Known = HashMap<Handle<Expression>, Value>;

impl Reader<'_> {
    fn atom(&mut self, atom: Atom) -> Sum {
        let known = self.atoms.iter().position(|known| *known == atom);
        let number = known.unwrap_or_else(|| {
            self.atoms.push(atom);
            self.atoms.len() - 1
        });
        Sum::from([(vec![number], 1.0)])
    }

    fn input(&mut self, ty: &TypeInner, name: &str) -> Value {
        match ty {
            TypeInner::Scalar(scalar) if scalar.kind == ScalarKind::Float => {
                Value::Floats(vec![self.atom(Atom::Input(name.to_owned()))])
            }
            TypeInner::Vector { size, scalar } if scalar.kind == ScalarKind::Float => {
                let parts = "xyzw".chars().take(*size as usize);
                let parts = parts.map(|part| self.atom(Atom::Input(format!("{name}.{part}"))));
                Value::Floats(parts.collect())
            }
            _ => Value::Word(name.to_owned()),
        }
    }

    fn call(&mut self, handle: Handle<Function>, arguments: Vec<Value>) -> Value {
        let function = &self.module.functions[handle];
        let mut known = Known::new();
        for statement in &function.body {
            match statement {
                Statement::Emit(_) => {}
                Statement::Call { function: called, arguments: passed, result } => {
                    let passed = passed
                        .iter()
                        .map(|&each| self.value(handle, each, &arguments, &mut known))
                        .collect();
                    let value = self.call(*called, passed);
                    known.extend(result.map(|result| (result, value)));
                }
                Statement::Return { value: Some(value) } => {
                    return self.value(handle, *value, &arguments, &mut known);
                }
                other => panic!("{other:?} in {:?}", function.name),
            }
        }
        panic!("{:?} returns nothing", function.name)
    }

    fn value(
        &mut self,
        of: Handle<Function>,
        handle: Handle<Expression>,
        arguments: &[Value],
        known: &mut Known,
    ) -> Value {
        if let Some(value) = known.get(&handle) {
            return value.clone();
        }
        let (module, info) = (self.module, self.info);
        let ty = |handle: Handle<Expression>| info[of][handle].ty.inner_with(&module.types);
        let mut value = |expression| self.value(of, expression, arguments, known);
        let found = match module.functions[of].expressions[handle] {
            Expression::FunctionArgument(i) => arguments[i as usize].clone(),
            Expression::Literal(literal) => literal_value(literal),
            Expression::Constant(constant) => {
                let init = module.constants[constant].init;
                match module.global_expressions[init] {
                    Expression::Literal(literal) => literal_value(literal),
                    ref other => panic!("{other:?}"),
                }
            }
            Expression::GlobalVariable(global) => {
                Value::Word(module.global_variables[global].name.clone().unwrap())
            }
            Expression::Compose { ref components, .. } => {
                let parts = components.iter().flat_map(|&part| value(part).floats());
                Value::Floats(parts.collect())
            }
            Expression::Splat { size, value: part } => match value(part) {
                Value::Floats(floats) => Value::Floats(vec![floats[0].clone(); size as usize]),
                other => other,
            },
            Expression::Swizzle { size, vector, pattern } => {
                let floats = value(vector).floats();
                let parts = pattern.iter().take(size as usize);
                Value::Floats(parts.map(|&part| floats[part as usize].clone()).collect())
            }
            Expression::AccessIndex { base, index } => match value(base) {
                Value::Floats(floats) => Value::Floats(vec![floats[index as usize].clone()]),
                Value::Word(place) => Value::Word(match ty(base) {
                    TypeInner::Pointer { base, .. } => match &module.types[*base].inner {
                        TypeInner::Struct { members, .. } => {
                            format!("{place}.{}", members[index as usize].name.as_ref().unwrap())
                        }
                        TypeInner::Vector { .. } => {
                            format!("{place}.{}", &"xyzw"[index as usize..][..1])
                        }
                        _ => format!("{place}[{index}]"),
                    },
                    other => panic!("{other:?}"),
                }),
                bits => panic!("{bits:?}"),
            },
            Expression::Access { base, index } => {
                let (base, index) = (value(base).word(), value(index).word());
                Value::Word(format!("{base}[{index}]"))
            }
            Expression::Load { pointer } => {
                let place = value(pointer).word();
                return self.input(ty(handle), &place);
            }
            Expression::Unary { op: UnaryOperator::Negate, expr } => {
                Value::Floats(value(expr).floats().iter().map(|x| scaled(x, -1.0)).collect())
            }
            Expression::Binary { op, left, right } => binary(op, value(left), value(right)),
            Expression::As { expr, kind, convert: None } => match (value(expr), kind) {
                (Value::Floats(floats), ScalarKind::Uint) => Value::Bits { floats, hidden: false },
                (Value::Bits { floats, hidden: true }, ScalarKind::Float) => {
                    let atoms = floats.into_iter().map(|sum| self.atom(Atom::Opaque(sum)));
                    Value::Floats(atoms.collect())
                }
                (Value::Bits { floats, hidden: false }, ScalarKind::Float) => Value::Floats(floats),
                (Value::MaskedBits { floats, mask }, ScalarKind::Float) => {
                    let atoms = floats.into_iter().map(|sum| self.atom(Atom::Masked(sum, mask)));
                    Value::Floats(atoms.collect())
                }
                other => panic!("{other:?}"),
            },
            ref other => panic!("{other:?}"),
        };
        known.insert(handle, found.clone());
        found
    }
}

impl Value {
    fn floats(self) -> Vec<Sum> {
        let Value::Floats(floats) = self else { panic!("{self:?}") };
        floats
    }

    fn word(self) -> String {
        let Value::Word(word) = self else { panic!("{self:?}") };
        word
    }
}

fn literal_value(literal: Literal) -> Value {
    match literal {
        Literal::F32(x) => {
            let constant = Sum::from([(Vec::new(), f64::from(x))]);
            Value::Floats(vec![constant].into_iter().map(without_zeros).collect())
        }
        Literal::U32(n) => Value::Word(n.to_string()),
        other => panic!("{other:?}"),
    }
}

fn without_zeros(mut sum: Sum) -> Sum {
    sum.retain(|_, coefficient| *coefficient != 0.0);
    sum
}

fn scaled(sum: &Sum, factor: f64) -> Sum {
    sum.iter().map(|(atoms, &coefficient)| (atoms.clone(), factor * coefficient)).collect()
}

fn added(a: &Sum, b: &Sum) -> Sum {
    let mut sum = a.clone();
    for (atoms, coefficient) in b {
        *sum.entry(atoms.clone()).or_default() += coefficient;
    }
    without_zeros(sum)
}

fn multiplied(a: &Sum, b: &Sum) -> Sum {
    let mut product = Sum::new();
    for (left, x) in a {
        for (right, y) in b {
            let mut atoms = [&left[..], right].concat();
            atoms.sort_unstable();
            *product.entry(atoms).or_default() += x * y;
        }
    }
    without_zeros(product)
}

fn binary(op: BinaryOperator, left: Value, right: Value) -> Value {
    match (left, right) {
        (Value::Floats(left), Value::Floats(right)) => {
            let count = left.len().max(right.len());
            let pairs = (0..count).map(|i| (&left[i % left.len()], &right[i % right.len()]));
            let combined = pairs.map(|(a, b)| match op {
                BinaryOperator::Add => added(a, b),
                BinaryOperator::Subtract => added(a, &scaled(b, -1.0)),
                BinaryOperator::Multiply => multiplied(a, b),
                other => panic!("{other:?}"),
            });
            Value::Floats(combined.collect())
        }
        (Value::Bits { floats, .. }, Value::Word(zero)) if op == BinaryOperator::ExclusiveOr => {
            assert!(zero == "params.zero" || zero == "exchange.zero", "{zero}");
            Value::Bits { floats, hidden: true }
        }
        (Value::Bits { floats, .. }, Value::Word(mask)) if op == BinaryOperator::And => {
            Value::MaskedBits { floats, mask: mask.parse().unwrap() }
        }
        (Value::Word(left), Value::Word(right)) => Value::Word(format!("({left} {op:?} {right})")),
        other => panic!("{op:?} of {other:?}"),
    }
}
