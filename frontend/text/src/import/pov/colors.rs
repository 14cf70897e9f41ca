//! Colours: how they are written, and the names that every scene may use.

use jbt_model::diagnostic::{Diagnostic, Span};

use super::amount::Amount;
use super::scan::PovToken;
use super::script::{PovValue, Script};
use super::shape::Color;
use crate::import::srgb;

/// Words that begin a colour, and whether its numbers are encoded as screens have them.
const BEGINNINGS: [(&str, bool); 10] = [
    ("color", false),
    ("colour", false),
    ("rgb", false),
    ("rgbf", false),
    ("rgbt", false),
    ("rgbft", false),
    ("srgb", true),
    ("srgbf", true),
    ("srgbt", true),
    ("srgbft", true),
];

/// Components by their words.
const COMPONENTS: [&str; 5] = ["red", "green", "blue", "filter", "transmit"];

/// Whether a word begins a colour.
pub(super) fn begins(word: &str) -> bool {
    COMPONENTS.contains(&word) || BEGINNINGS.iter().any(|(known, _)| *known == word)
}

impl Script<'_> {
    /// A colour, at its first word.
    pub(super) fn color(&mut self) -> Result<Amount, Diagnostic> {
        let mut color = [0.0; 5];
        while let Some(word) = self.scanner.peek_word()? {
            if let Some(place) = COMPONENTS.iter().position(|known| *known == word) {
                let span = self.scanner.next()?.1;
                match self.expression()? {
                    Amount::Unknown(span) => return Ok(Amount::Unknown(span)),
                    amount => color[place] = self.real(amount, span)?,
                }
                continue;
            }
            let Some(&(_, encoded)) = BEGINNINGS.iter().find(|(known, _)| *known == word) else { break };
            self.scanner.next()?;
            let is_alone = matches!(word, "color" | "colour");
            if is_alone && self.scanner.peek_word()?.is_some_and(begins) {
                continue;
            }
            color = match self.expression()? {
                Amount::Number(number) => [number, number, number, 0.0, 0.0],
                Amount::Vector(numbers, _) if word.ends_with("rgbt") => {
                    let [red, green, blue, transmit, _] = numbers;
                    [red, green, blue, 0.0, transmit]
                }
                Amount::Vector(numbers, _) => numbers,
                Amount::Unknown(span) => return Ok(Amount::Unknown(span)),
            };
            if encoded {
                // To light, and then to what the scene takes numbers for.
                let inverse = self.gamma.recip();
                color[..3]
                    .iter_mut()
                    .for_each(|channel| *channel = srgb::decoded(*channel).max(0.0).powf(inverse));
            }
        }
        Ok(Amount::Vector(color, 5))
    }

    /// The linear colour of an amount; `None` for what has none.
    pub(super) fn linear(&self, amount: Amount) -> Option<Color> {
        let [red, green, blue] = match amount {
            Amount::Number(number) => [number; 3],
            Amount::Vector([red, green, blue, ..], _) => [red, green, blue],
            Amount::Unknown(_) => return None,
        };
        let light = |channel: f64| {
            if self.gamma == 1.0 { channel } else { channel.max(0.0).powf(self.gamma) }
        };
        let color = [red, green, blue].map(light);
        color.iter().all(|channel| channel.is_finite()).then_some(color)
    }

    /// The colour of a name in a pigment or a texture. `None` if it is no such name.
    pub(super) fn named_color(&self, word: &str) -> Option<Option<Color>> {
        match self.value(word) {
            Some(PovValue::Look(color)) => Some(*color),
            Some(PovValue::Amount(amount)) => Some(self.linear(*amount)),
            Some(PovValue::Shapes(_) | PovValue::Transform(_) | PovValue::Other) => None,
            None => color(word)
                .map(|[red, green, blue, _]| self.linear(Amount::Vector([red, green, blue, 0.0, 0.0], 3))),
        }
    }

    /// What the scene takes numbers of colours for.
    pub(super) fn assumed_gamma(&mut self, span: Span) -> Result<(), Diagnostic> {
        if self.scanner.peek_word()? == Some("srgb") {
            self.scanner.next()?;
            self.gamma = 2.2;
            return Ok(());
        }
        let amount = self.expression()?;
        let gamma = self.real(amount, span)?;
        if !(0.1..=10.0).contains(&gamma) {
            let error = Diagnostic::error(Some(span), format!("the gamma is {gamma}"));
            return Err(error.expected("expected a number near 1 or 2.2"));
        }
        self.gamma = gamma;
        Ok(())
    }

    /// Whether the next token is a colour in a vector or in words.
    pub(super) fn is_color_next(&mut self) -> Result<bool, Diagnostic> {
        let (token, _) = self.scanner.peek()?;
        Ok(token == PovToken::Mark(b'<') || self.scanner.peek_word()?.is_some_and(begins))
    }
}

/// The names of POV-Ray's own file of colours, `colors.inc`: red, green and blue.
const NAMES: &[(&str, [f64; 3])] = &[
    ("Red", [1.0, 0.0, 0.0]),
    ("Green", [0.0, 1.0, 0.0]),
    ("Blue", [0.0, 0.0, 1.0]),
    ("Yellow", [1.0, 1.0, 0.0]),
    ("Cyan", [0.0, 1.0, 1.0]),
    ("Magenta", [1.0, 0.0, 1.0]),
    ("White", [1.0, 1.0, 1.0]),
    ("Black", [0.0, 0.0, 0.0]),
    ("DimGray", [0.329412, 0.329412, 0.329412]),
    ("DimGrey", [0.329412, 0.329412, 0.329412]),
    ("Gray", [0.752941, 0.752941, 0.752941]),
    ("Grey", [0.752941, 0.752941, 0.752941]),
    ("LightGray", [0.658824, 0.658824, 0.658824]),
    ("LightGrey", [0.658824, 0.658824, 0.658824]),
    ("VLightGray", [0.8, 0.8, 0.8]),
    ("VLightGrey", [0.8, 0.8, 0.8]),
    ("Aquamarine", [0.439216, 0.858824, 0.576471]),
    ("BlueViolet", [0.62352, 0.372549, 0.623529]),
    ("Brown", [0.647059, 0.164706, 0.164706]),
    ("CadetBlue", [0.372549, 0.623529, 0.623529]),
    ("Coral", [1.0, 0.498039, 0.0]),
    ("CornflowerBlue", [0.258824, 0.258824, 0.435294]),
    ("DarkGreen", [0.184314, 0.309804, 0.184314]),
    ("DarkOliveGreen", [0.309804, 0.309804, 0.184314]),
    ("DarkOrchid", [0.6, 0.196078, 0.8]),
    ("DarkSlateBlue", [0.119608, 0.137255, 0.556863]),
    ("DarkSlateGray", [0.184314, 0.309804, 0.309804]),
    ("DarkSlateGrey", [0.184314, 0.309804, 0.309804]),
    ("DarkTurquoise", [0.439216, 0.576471, 0.858824]),
    ("Firebrick", [0.556863, 0.137255, 0.137255]),
    ("ForestGreen", [0.137255, 0.556863, 0.137255]),
    ("Gold", [0.8, 0.498039, 0.196078]),
    ("Goldenrod", [0.858824, 0.858824, 0.439216]),
    ("GreenYellow", [0.576471, 0.858824, 0.439216]),
    ("IndianRed", [0.309804, 0.184314, 0.184314]),
    ("Khaki", [0.623529, 0.623529, 0.372549]),
    ("LightBlue", [0.74902, 0.847059, 0.847059]),
    ("LightSteelBlue", [0.560784, 0.560784, 0.737255]),
    ("LimeGreen", [0.196078, 0.8, 0.196078]),
    ("Maroon", [0.556863, 0.137255, 0.419608]),
    ("MediumAquamarine", [0.196078, 0.8, 0.6]),
    ("MediumBlue", [0.196078, 0.196078, 0.8]),
    ("MediumForestGreen", [0.419608, 0.556863, 0.137255]),
    ("MediumGoldenrod", [0.917647, 0.917647, 0.678431]),
    ("MediumOrchid", [0.576471, 0.439216, 0.858824]),
    ("MediumSeaGreen", [0.258824, 0.435294, 0.258824]),
    ("MediumSlateBlue", [0.498039, 0.0, 1.0]),
    ("MediumSpringGreen", [0.498039, 1.0, 0.0]),
    ("MediumTurquoise", [0.439216, 0.858824, 0.858824]),
    ("MediumVioletRed", [0.858824, 0.439216, 0.576471]),
    ("MidnightBlue", [0.184314, 0.184314, 0.309804]),
    ("Navy", [0.137255, 0.137255, 0.556863]),
    ("NavyBlue", [0.137255, 0.137255, 0.556863]),
    ("Orange", [1.0, 0.5, 0.0]),
    ("OrangeRed", [1.0, 0.25, 0.0]),
    ("Orchid", [0.858824, 0.439216, 0.858824]),
    ("PaleGreen", [0.560784, 0.737255, 0.560784]),
    ("Pink", [0.737255, 0.560784, 0.560784]),
    ("Plum", [0.917647, 0.678431, 0.917647]),
    ("Salmon", [0.435294, 0.258824, 0.258824]),
    ("SeaGreen", [0.137255, 0.556863, 0.419608]),
    ("Sienna", [0.556863, 0.419608, 0.137255]),
    ("SkyBlue", [0.196078, 0.6, 0.8]),
    ("SlateBlue", [0.0, 0.498039, 1.0]),
    ("SpringGreen", [0.0, 1.0, 0.498039]),
    ("SteelBlue", [0.137255, 0.419608, 0.556863]),
    ("Tan", [0.858824, 0.576471, 0.439216]),
    ("Thistle", [0.847059, 0.74902, 0.847059]),
    ("Turquoise", [0.678431, 0.917647, 0.917647]),
    ("Violet", [0.309804, 0.184314, 0.309804]),
    ("VioletRed", [0.8, 0.196078, 0.6]),
    ("Wheat", [0.847059, 0.847059, 0.74902]),
    ("YellowGreen", [0.6, 0.8, 0.196078]),
    ("SummerSky", [0.22, 0.69, 0.87]),
    ("RichBlue", [0.35, 0.35, 0.67]),
    ("Brass", [0.71, 0.65, 0.26]),
    ("Copper", [0.72, 0.45, 0.2]),
    ("Bronze", [0.55, 0.47, 0.14]),
    ("Bronze2", [0.65, 0.49, 0.24]),
    ("Silver", [0.9, 0.91, 0.98]),
    ("BrightGold", [0.85, 0.85, 0.1]),
    ("OldGold", [0.81, 0.71, 0.23]),
    ("Feldspar", [0.82, 0.57, 0.46]),
    ("Quartz", [0.85, 0.85, 0.95]),
    ("Mica", [0.0, 0.0, 0.0]),
    ("NeonPink", [1.0, 0.43, 0.78]),
    ("DarkPurple", [0.53, 0.12, 0.47]),
    ("NeonBlue", [0.3, 0.3, 1.0]),
    ("CoolCopper", [0.85, 0.53, 0.1]),
    ("MandarinOrange", [0.89, 0.47, 0.2]),
    ("LightWood", [0.91, 0.76, 0.65]),
    ("MediumWood", [0.65, 0.5, 0.39]),
    ("DarkWood", [0.52, 0.37, 0.26]),
    ("SpicyPink", [1.0, 0.11, 0.68]),
    ("SemiSweetChoc", [0.42, 0.26, 0.15]),
    ("BakersChoc", [0.36, 0.2, 0.09]),
    ("Flesh", [0.96, 0.8, 0.69]),
    ("NewTan", [0.92, 0.78, 0.62]),
    ("NewMidnightBlue", [0.0, 0.0, 0.61]),
    ("VeryDarkBrown", [0.35, 0.16, 0.14]),
    ("DarkBrown", [0.36, 0.25, 0.2]),
    ("DarkTan", [0.59, 0.41, 0.31]),
    ("GreenCopper", [0.32, 0.49, 0.46]),
    ("DkGreenCopper", [0.29, 0.46, 0.43]),
    ("DustyRose", [0.52, 0.39, 0.39]),
    ("HuntersGreen", [0.13, 0.37, 0.31]),
    ("Scarlet", [0.55, 0.09, 0.09]),
    ("Med_Purple", [0.73, 0.16, 0.96]),
    ("Light_Purple", [0.87, 0.58, 0.98]),
    ("Very_Light_Purple", [0.94, 0.81, 0.99]),
];

/// Red, green, blue and filter of a name that every scene may use: those of [`NAMES`], clear, and greys by
/// their percentage, `Gray05` to `Gray95`.
pub(super) fn color(name: &str) -> Option<[f64; 4]> {
    if name == "Clear" {
        return Some([1.0; 4]);
    }
    let grey = || {
        let digits = name.strip_prefix("Gray").filter(|digits| digits.len() == 2)?;
        let percent = digits.parse::<u8>().ok().filter(|percent| percent % 5 == 0 && *percent > 0)?;
        let light = f64::from(percent) / 100.0;
        Some([light, light, light, 0.0])
    };
    let named = NAMES.iter().find(|(known, _)| *known == name);
    named.map(|&(_, [red, green, blue])| [red, green, blue, 0.0]).or_else(grey)
}
