//! A text as tokens, each with the place of its first character, counted from 1.

use crate::error::FormulaError;
use std::fmt;

/// Most characters of a formula.
const MOST_CHARACTERS: usize = 100_000;

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Token {
    Number(f64),
    Name(String),
    /// One of `+ - * / ^ ( ) ,`.
    Sign(char),
    End,
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Token::Number(number) => write!(f, "`{number}`"),
            Token::Name(name) => write!(f, "`{name}`"),
            Token::Sign(sign) => write!(f, "`{sign}`"),
            Token::End => write!(f, "the end"),
        }
    }
}

/// All tokens of a text; the last one is [`Token::End`].
pub(crate) fn tokens(text: &str) -> Result<Vec<(Token, usize)>, FormulaError> {
    let text: Vec<char> = text.chars().collect();
    if text.len() > MOST_CHARACTERS {
        return Err(FormulaError::TooLong {
            length: text.len(),
            most: MOST_CHARACTERS,
        });
    }
    let (mut all, mut i) = (Vec::new(), 0);
    while i < text.len() {
        let (first, character) = (i, text[i]);
        let token = match character {
            _ if character.is_whitespace() => {
                i += 1;
                continue;
            }
            '0'..='9' | '.' => {
                i = end_of_number(&text, i);
                number(&text[first..i], first + 1)?
            }
            _ if character.is_ascii_alphabetic() => {
                i = end_of(&text, i, |c| c.is_ascii_alphanumeric() || c == '_');
                Token::Name(text[first..i].iter().collect())
            }
            '*' if text.get(i + 1) == Some(&'*') => {
                i += 2;
                Token::Sign('^')
            }
            _ => {
                i += 1;
                sign(character, i)?
            }
        };
        all.push((token, first + 1));
    }
    if all.is_empty() {
        return Err(FormulaError::Empty);
    }
    all.push((Token::End, text.len() + 1));
    Ok(all)
}

/// One character that is a token.
fn sign(character: char, at: usize) -> Result<Token, FormulaError> {
    let instead = match character {
        '+' | '-' | '*' | '/' | '^' | '(' | ')' | ',' => return Ok(Token::Sign(character)),
        '−' | '–' => return Ok(Token::Sign('-')),
        '·' | '⋅' | '×' => return Ok(Token::Sign('*')),
        'π' => return Ok(Token::Name("pi".into())),
        '[' | '{' => "write (",
        ']' | '}' => "write )",
        '²' => "write ^2",
        '³' => "write ^3",
        '√' => "write sqrt( … )",
        '|' => "write abs( … )",
        '=' => "write the right-hand side of H = … alone",
        _ => "write numbers, names, + - * / ^ and parentheses",
    };
    Err(FormulaError::UnknownCharacter {
        character,
        at,
        instead,
    })
}

fn number(text: &[char], at: usize) -> Result<Token, FormulaError> {
    let text: String = text.iter().collect();
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(Token::Number(number)),
        _ => Err(FormulaError::Number { text, at }),
    }
}

fn end_of(text: &[char], from: usize, belongs: impl Fn(char) -> bool) -> usize {
    let length = text[from..].iter().take_while(|&&c| belongs(c)).count();
    from + length
}

/// Digits and points, and an exponent if there is one.
fn end_of_number(text: &[char], from: usize) -> usize {
    let end = end_of(text, from, |c| c.is_ascii_digit() || c == '.');
    if !matches!(text.get(end), Some('e' | 'E')) {
        return end;
    }
    let has_sign = matches!(text.get(end + 1), Some('+' | '-'));
    let digits = end + 1 + usize::from(has_sign);
    match end_of(text, digits.min(text.len()), |c| c.is_ascii_digit()) {
        exponent if exponent > digits => exponent,
        _ => end,
    }
}
