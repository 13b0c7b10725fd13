//! The grammar of a formula.

use fmm_model::Scalar;
use winnow::ascii::{digit0, digit1, multispace0};
use winnow::combinator::{
    Infix, Postfix, Prefix, alt, cut_err, delimited, dispatch, empty, expression, fail, not, opt, peek, preceded,
    terminated,
};
use winnow::error::{ContextError, ErrMode};
use winnow::prelude::*;
use winnow::token::{any, one_of, take_while};

use crate::error::UncertaintyError;

/// Parentheses, powers and signs that a formula may have within each other: each takes the parser one level deeper.
const DEEPEST: usize = 200;

/// One step of an evaluation, on a stack of values.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Step {
    Number(f64),
    /// A quantity by its name, as the parser leaves it.
    Name(String),
    /// A quantity by its place.
    Quantity(usize),
    OfOne(Function),
    OfTwo(Operator),
    /// A whole power, of a base of either sign.
    Power(i32),
}

/// A function of one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Function {
    Minus,
    Sqrt,
    Exp,
    Ln,
    Log10,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Abs,
}

const FUNCTIONS: [(&str, Function); 14] = [
    ("sqrt", Function::Sqrt),
    ("exp", Function::Exp),
    ("ln", Function::Ln),
    ("log10", Function::Log10),
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("asin", Function::Asin),
    ("acos", Function::Acos),
    ("atan", Function::Atan),
    ("sinh", Function::Sinh),
    ("cosh", Function::Cosh),
    ("tanh", Function::Tanh),
    ("abs", Function::Abs),
];

impl Function {
    pub(super) fn of<D: Scalar>(self, x: D) -> D {
        let cosine = |sine: D| ((D::from(1.0) - sine) * (sine + 1.0)).sqrt();
        match self {
            Self::Minus => -x,
            Self::Sqrt => x.sqrt(),
            Self::Exp => x.exp(),
            Self::Ln => x.ln(),
            Self::Log10 => x.log10(),
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.tan(),
            Self::Asin => x.atan2(cosine(x)),
            Self::Acos => cosine(x).atan2(x),
            Self::Atan => x.atan(),
            // Without the difference of two numbers that are nearly 1.
            Self::Sinh => (x * 0.5).tanh() * (x.exp() + 1.0) * ((-x).exp() + 1.0) * 0.5,
            Self::Cosh => (x.exp() + (-x).exp()) * 0.5,
            Self::Tanh => x.tanh(),
            Self::Abs => x.abs(),
        }
    }
}

/// An operation on two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Operator {
    Plus,
    Minus,
    Times,
    Over,
    Power,
    Atan2,
}

impl Operator {
    pub(super) fn of<D: Scalar>(self, first: D, second: D) -> D {
        match self {
            Self::Plus => first + second,
            Self::Minus => first - second,
            Self::Times => first * second,
            Self::Over => first / second,
            Self::Power => first.powf(second),
            Self::Atan2 => first.atan2(second),
        }
    }
}

fn begins_name(letter: char) -> bool {
    letter.is_alphabetic() || letter == '_'
}

fn goes_on(letter: char) -> bool {
    (letter.is_alphanumeric() || letter == '_') && !matches!(letter, '²' | '³')
}

/// True for a text that may be the name of a quantity.
pub(super) fn is_name(text: &str) -> bool {
    let is_taken = matches!(text, "pi" | "π" | "atan2") || FUNCTIONS.iter().any(|(name, _)| *name == text);
    text.chars().next().is_some_and(begins_name) && text.chars().all(goes_on) && !is_taken
}

type Steps = Vec<Step>;

/// The steps of a formula, with quantities by their names.
pub(super) fn parse(text: &str) -> Result<Steps, UncertaintyError> {
    if depth(text) > DEEPEST {
        let what = format!("a formula may have at most {DEEPEST} parentheses, powers and signs within each other");
        return Err(UncertaintyError::model(what));
    }
    let steps = preceded(multispace0, sum).parse(text).map_err(|error| {
        let rest = text.get(error.offset()..).unwrap_or_default();
        not_a_formula(text, rest)
    })?;
    match steps.iter().find_map(|step| if let Step::Name(name) = step { name.strip_suffix('(') } else { None }) {
        Some(name) => {
            let known = FUNCTIONS.map(|(name, _)| name).join(", ");
            Err(UncertaintyError::model(format!("there is no function {name}; there are {known} and atan2")))
        }
        None => Ok(steps),
    }
}

/// Greatest number of parentheses, powers and signs of a formula that lie within each other. A sum may be as long as it likes.
fn depth(text: &str) -> usize {
    // Powers and signs since the last weaker operator, for each parenthesis that is open.
    let (mut chains, mut depth, mut deepest) = (vec![0], 0, 0);
    let mut operand = false;
    for letter in text.chars().filter(|letter| !letter.is_whitespace()) {
        let is_sign = matches!(letter, '+' | '-') && !operand;
        match letter {
            '(' => {
                chains.push(0);
                depth += 1;
            }
            ')' if chains.len() > 1 => depth -= 1 + chains.pop().unwrap_or(0),
            '+' | '-' | '*' | '/' | ',' if !is_sign => depth -= chains.last_mut().map_or(0, std::mem::take),
            '^' | '+' | '-' => {
                depth += 1;
                chains.last_mut().into_iter().for_each(|chain| *chain += 1);
            }
            _ => {}
        }
        operand = !matches!(letter, '(' | ',' | '+' | '-' | '*' | '/' | '^');
        deepest = deepest.max(depth);
    }
    deepest
}

/// Error of a text that is no formula from `rest` on.
pub(super) fn not_a_formula(text: &str, rest: &str) -> UncertaintyError {
    let place = if rest.is_empty() { "at its end".to_owned() } else { format!("from {rest:?} on") };
    let advice = "write products with *, powers with ^";
    UncertaintyError::model(format!("{text:?} cannot be read as a formula {place}; {advice}"))
}

type Parsed<T> = ModalResult<T, ContextError>;

fn spaced<'i, O>(
    parser: impl Parser<&'i str, O, ErrMode<ContextError>>,
) -> impl Parser<&'i str, O, ErrMode<ContextError>> {
    terminated(parser, multispace0)
}

fn of_two(mut first: Steps, second: Steps, operator: Operator) -> Steps {
    match second[..] {
        [Step::Number(exponent)] if operator == Operator::Power && whole(exponent).is_some() => {
            first.extend(whole(exponent).map(Step::Power));
        }
        [Step::Number(exponent), Step::OfOne(Function::Minus)]
            if operator == Operator::Power && whole(exponent).is_some() =>
        {
            first.extend(whole(-exponent).map(Step::Power));
        }
        _ => {
            first.extend(second);
            first.push(Step::OfTwo(operator));
        }
    }
    first
}

/// The exponent as a whole number, if it is a small one.
fn whole(exponent: f64) -> Option<i32> {
    (exponent.fract() == 0.0 && exponent.abs() <= 64.0).then_some(exponent as i32)
}

fn then(mut steps: Steps, step: Step) -> Steps {
    steps.push(step);
    steps
}

fn sum(input: &mut &str) -> Parsed<Steps> {
    use Operator::{Minus, Over, Plus, Power, Times};
    expression(operand)
        .prefix(dispatch! {spaced(terminated(one_of(['-', '+']), peek(not(one_of(['-', '+'])))));
            '-' => empty.value(Prefix(8, |_: &mut _, x| Ok(then(x, Step::OfOne(Function::Minus))))),
            _ => empty.value(Prefix(8, |_: &mut _, x| Ok(x))),
        })
        .postfix(dispatch! {spaced(any);
            '²' => empty.value(Postfix(12, |_: &mut _, x| Ok(then(x, Step::Power(2))))),
            '³' => empty.value(Postfix(12, |_: &mut _, x| Ok(then(x, Step::Power(3))))),
            _ => fail,
        })
        .infix(dispatch! {spaced(any);
            '+' => empty.value(Infix::Left(5, |_: &mut _, a, b| Ok(of_two(a, b, Plus)))),
            '-' => empty.value(Infix::Left(5, |_: &mut _, a, b| Ok(of_two(a, b, Minus)))),
            '*' => empty.value(Infix::Left(7, |_: &mut _, a, b| Ok(of_two(a, b, Times)))),
            '/' => empty.value(Infix::Left(7, |_: &mut _, a, b| Ok(of_two(a, b, Over)))),
            '^' => empty.value(Infix::Right(10, |_: &mut _, a, b| Ok(of_two(a, b, Power)))),
            _ => fail,
        })
        .parse_next(input)
}

fn operand(input: &mut &str) -> Parsed<Steps> {
    alt((in_parentheses, number.map(|value| vec![Step::Number(value)]), of_name)).parse_next(input)
}

/// An opening parenthesis begins nothing else, so that the error names the place of a mistake.
fn in_parentheses(input: &mut &str) -> Parsed<Steps> {
    delimited(spaced('('), cut_err(sum), cut_err(spaced(')'))).parse_next(input)
}

/// A quantity, a constant, or a function with its arguments.
fn of_name(input: &mut &str) -> Parsed<Steps> {
    let name = spaced(name).parse_next(input)?;
    if name == "atan2" {
        let (y, x) = (preceded(cut_err(spaced('(')), cut_err(sum)), preceded(cut_err(spaced(',')), cut_err(sum)))
            .parse_next(input)?;
        cut_err(spaced(')')).parse_next(input)?;
        return Ok(of_two(y, x, Operator::Atan2));
    }
    let function = FUNCTIONS.iter().find(|(known, _)| *known == name);
    match (opt(in_parentheses).parse_next(input)?, function) {
        (Some(argument), Some((_, function))) => Ok(then(argument, Step::OfOne(*function))),
        // No name has a parenthesis: the error calls this one a function that does not exist.
        (Some(argument), None) => Ok(then(argument, Step::Name(format!("{name}(")))),
        (None, None) if matches!(name, "pi" | "π") => Ok(vec![Step::Number(std::f64::consts::PI)]),
        (None, None) => Ok(vec![Step::Name(name.to_owned())]),
        (None, Some(_)) => cut_err(fail).parse_next(input),
    }
}

fn name<'i>(input: &mut &'i str) -> Parsed<&'i str> {
    (one_of(begins_name), take_while(0.., goes_on)).take().parse_next(input)
}

fn number(input: &mut &str) -> Parsed<f64> {
    let mantissa = alt(((digit1, opt(('.', digit0))).void(), ('.', digit1).void()));
    let exponent = (one_of(['e', 'E']), opt(one_of(['+', '-'])), digit1);
    spaced((mantissa, opt(exponent)).take().parse_to()).parse_next(input)
}
