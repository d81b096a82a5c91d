//! Why a text is no formula, and why a simulation could not start. Characters are counted from 1.

use equip::autodiff::BuildError;
use equip::integrate::IntegrateError;

/// Why a text is no formula: what is wrong, where, and what to write instead.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormulaError {
    /// A text without a formula.
    #[error("the formula is empty: write one such as p^2/2 - cos(q)")]
    Empty,
    /// A text of very many characters.
    #[error("the formula has {length} characters: write at most {most}")]
    TooLong {
        /// Characters of the text.
        length: usize,
        /// Characters allowed.
        most: usize,
    },
    /// A character that formulas do not have.
    #[error("`{character}` at character {at} has no meaning in a formula: {instead}")]
    UnknownCharacter {
        /// The character.
        character: char,
        /// Its place.
        at: usize,
        /// What to write.
        instead: &'static str,
    },
    /// Digits and points that are no finite number.
    #[error("`{text}` at character {at} is not a finite number: write one such as 0.5 or 1e-3")]
    Number {
        /// Digits and points.
        text: String,
        /// Place of the first.
        at: usize,
    },
    /// A name that is no variable.
    #[error("the name `{name}` at character {at} is unknown: write {names}, or a number")]
    UnknownName {
        /// The name.
        name: String,
        /// Its place.
        at: usize,
        /// The names there are.
        names: String,
    },
    /// A name before a parenthesis that is no function.
    #[error("`{name}` at character {at} is not a function: write {instead}")]
    UnknownFunction {
        /// The name.
        name: String,
        /// Its place.
        at: usize,
        /// What to write.
        instead: String,
    },
    /// A function whose argument is not in parentheses.
    #[error("the function `{name}` at character {at} has no argument: write {name}( … )")]
    NoArgument {
        /// The function.
        name: &'static str,
        /// Its place.
        at: usize,
    },
    /// A function with too many or too few arguments.
    #[error(
        "the function `{name}` at character {at} has {found} arguments: write {expected}, separated by commas; \
         numbers have a decimal point"
    )]
    Arguments {
        /// The function.
        name: &'static str,
        /// Its place.
        at: usize,
        /// Arguments it takes.
        expected: usize,
        /// Arguments in the text.
        found: usize,
    },
    /// A comma between no arguments.
    #[error(
        "the comma at character {at} does not separate arguments of a function: write a decimal point in a number, 1.5"
    )]
    Comma {
        /// Its place.
        at: usize,
    },
    /// An operator without one of its operands.
    #[error(
        "a number, a variable or a parenthesis is missing before {before} at character {at}: write it there"
    )]
    MissingOperand {
        /// What stands there instead.
        before: String,
        /// Place of that.
        at: usize,
    },
    /// Two operands without an operator.
    #[error(
        "an operator is missing before {before} at character {at}: write * there if a product is meant"
    )]
    MissingOperator {
        /// The second operand.
        before: String,
        /// Its place.
        at: usize,
    },
    /// An opening parenthesis without a closing one.
    #[error("the parenthesis opened at character {at} is not closed: write ) where it ends")]
    NotClosed {
        /// Place of the opening one.
        at: usize,
    },
    /// A closing parenthesis without an opening one.
    #[error(
        "the parenthesis closed at character {at} was not opened: write ( before it, or leave it out"
    )]
    NotOpened {
        /// Place of the closing one.
        at: usize,
    },
    /// Very many parentheses, signs or powers within each other.
    #[error(
        "at character {at} more than {most} levels are nested: write the formula with fewer parentheses"
    )]
    TooDeep {
        /// Place of the first level too many.
        at: usize,
        /// Levels allowed.
        most: usize,
    },
    /// A formula of numbers alone.
    #[error("H depends on no variable, so nothing moves: write {names}")]
    NoVariable {
        /// The names there are.
        names: String,
    },
}

/// Why a simulation could not start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// H is no formula.
    #[error("{0}")]
    Formula(#[from] FormulaError),
    /// Positions and momenta do not pair.
    #[error(
        "there are {positions} initial positions q and {momenta} initial momenta p: give as many of one as of the other"
    )]
    Lengths {
        /// Positions given.
        positions: usize,
        /// Momenta given.
        momenta: usize,
    },
    /// No degree of freedom, or very many.
    #[error("there are {found} degrees of freedom: give 1 to {most} initial positions")]
    DegreesOfFreedom {
        /// Positions given.
        found: usize,
        /// Positions allowed.
        most: usize,
    },
    /// H is infinite or NaN at the initial condition.
    #[error(
        "H is {value} at the initial condition: change q or p, or check H for a division by zero, a root or a \
         logarithm of a negative number"
    )]
    EnergyNotFinite {
        /// H there.
        value: f64,
    },
    /// The library does not accept H.
    #[error("{0}")]
    Build(#[from] BuildError),
    /// The library does not accept the initial condition, the step or the stages.
    #[error("{0}")]
    Start(#[from] IntegrateError<f64>),
}
